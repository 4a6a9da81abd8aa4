// Who gets in: certificates and tokens, as deploy/certs makes them.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

#include "proto/convert.h"
#include "tests/system/cluster/calm.h"

namespace penumbra {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// A farm behind TLS. Everything of one folder `certs`; `strangers` is another authority's.
class Security : public testing::Test {
 protected:
  void SetUp() override {
    cluster_ = std::make_unique<Cluster>(test_name());
    certs({"certs", "server", "localhost,127.0.0.1"});
    certs({"certs", "worker", "node1"});
    certs({"certs", "client", "ada"});
    certs({"certs", "token", "ada", "submit", "jobs=2", "tasks=1"});
    certs({"certs", "token", "bob", "submit"});
    certs({"certs", "token", "farm", "work"});
    certs({"certs", "token", "root", "admin"});
  }

  void certs(std::vector<std::string> words) {
    size_t folder = words[0] == "--days" ? 2 : 0;
    words[folder] = cluster_->path(words[folder]);
    words.insert(words.begin(), PENUMBRA_CERTS);
    ASSERT_EQ(Process(words, cluster_->path("certs.log")).wait(30), 0)
        << text_of(cluster_->path("certs.log"));
  }

  std::string file(const std::string& name, const std::string& folder = "certs") const {
    return cluster_->path(folder + "/" + name);
  }
  Credentials as(const std::string& user, const std::string& cert = "ada") const {
    return {file(cert + ".pem"), file(cert + "-key.pem"), file("ca.pem"), file(user + ".token")};
  }

  void start_server() {
    cluster_->server_flags = {"--tls-cert", file("server.pem"), "--tls-key",    file("server-key.pem"),
                              "--tls-ca",   file("ca.pem"),     "--token-file", file("tokens")};
    cluster_->credentials = as("root");
    cluster_->start_server();
    cluster_->worker_flags = {"--tls-cert", file("node1.pem"), "--tls-key",    file("node1-key.pem"),
                              "--tls-ca",   file("ca.pem"),    "--token-file", file("farm.token")};
  }

  grpc::Status list_jobs(const Credentials& credentials) {
    const auto channel = open_channel(cluster_->address(), credentials);
    EXPECT_TRUE(channel.ok()) << channel.status();
    const auto stub = v1::Render::NewStub(*channel);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(5));
    v1::ListJobsResponse jobs;
    return stub->ListJobs(&context, {}, &jobs);
  }

  grpc::Status sync(const Credentials& credentials) {
    const auto stub = v1::Worker::NewStub(*open_channel(cluster_->address(), credentials));
    grpc::ClientContext context;
    WorkerState state;
    state.worker = {"id", "host", "avx2", 1};
    state.name = "n";
    v1::SyncResponse response;
    return stub->Sync(&context, to_proto(state), &response);
  }

  std::unique_ptr<Cluster> cluster_;
};

TEST_F(Security, AJobRunsBehindCertificatesAndTokens) {
  start_server();
  cluster_->start_worker(2);
  expect_calm(*cluster_, cluster_->submit(cluster_->spec(cluster_->upload_scene("0"))));
  std::istringstream tokens(text_of(file("tokens")));
  for (std::string line; std::getline(tokens, line);) {
    const std::string token = line.substr(0, line.find(' '));
    EXPECT_EQ(cluster_->server_log().find(token), std::string::npos) << "a token is in the log";
    EXPECT_EQ(text_of(cluster_->path("worker.log")).find(token), std::string::npos);
  }
}

TEST_F(Security, StrangersAreNotLetIn) {
  start_server();
  EXPECT_TRUE(list_jobs(as("ada")).ok());
  EXPECT_FALSE(list_jobs({}).ok()) << "no TLS";
  EXPECT_FALSE(list_jobs({"", "", file("ca.pem"), file("ada.token")}).ok()) << "no certificate";
  certs({"strangers", "client", "eve"});
  EXPECT_FALSE(list_jobs({file("eve.pem", "strangers"), file("eve-key.pem", "strangers"), file("ca.pem"),
                          file("ada.token")})
                   .ok())
      << "another authority's certificate";
  EXPECT_FALSE(
      list_jobs({file("ada.pem"), file("ada-key.pem"), file("ca.pem", "strangers"), file("ada.token")}).ok())
      << "the server's certificate is not of the authority that the client believes";
  certs({"--days", "0", "certs", "client", "old"});
  std::this_thread::sleep_for(std::chrono::seconds(2));
  EXPECT_FALSE(list_jobs(as("ada", "old")).ok()) << "an expired certificate";
}

TEST_F(Security, TokensAreWantedAndSayWhatIsAllowed) {
  start_server();
  Credentials none = as("ada");
  none.token_file.clear();
  EXPECT_EQ(list_jobs(none).error_code(), grpc::StatusCode::UNAUTHENTICATED);
  std::ofstream(file("guess.token")) << "guess";
  EXPECT_EQ(list_jobs(as("guess")).error_code(), grpc::StatusCode::UNAUTHENTICATED);
  EXPECT_EQ(list_jobs(as("farm")).error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_EQ(sync(as("ada")).error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_TRUE(sync(as("farm", "node1")).ok());
  EXPECT_TRUE(sync(as("root")).ok());
}

TEST_F(Security, UsersKeepToTheirJobsAndTheirQuota) {
  start_server();
  const Digest bundle = cluster_->upload_scene("50");
  const auto connect = [&](const std::string& user) {
    return v1::Render::NewStub(*open_channel(cluster_->address(), as(user)));
  };
  const auto submit = [&](v1::Render::Stub& stub, const std::string& request_id, std::string* job) {
    v1::SubmitRequest request;
    *request.mutable_spec() = to_proto(cluster_->spec(bundle));
    request.mutable_terms()->set_user("root");  // is not believed
    request.set_request_id(request_id);
    grpc::ClientContext context;
    v1::SubmitResponse response;
    const grpc::Status status = stub.Submit(&context, request, &response);
    if (job != nullptr) *job = response.job();
    return status;
  };
  const auto cancel = [](v1::Render::Stub& stub, const std::string& job) {
    grpc::ClientContext context;
    v1::JobRequest request;
    request.set_job(job);
    v1::JobStatus response;
    return stub.Cancel(&context, request, &response);
  };
  const auto ada = connect("ada"), bob = connect("bob"), root = connect("root");
  std::string first, second;
  ASSERT_TRUE(submit(*ada, "a1", &first).ok());
  ASSERT_TRUE(submit(*ada, "a2", &second).ok());
  EXPECT_EQ(submit(*ada, "a3", nullptr).error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_TRUE(submit(*ada, "a2", nullptr).ok()) << "the same request again is no new job";
  EXPECT_EQ(cluster_->status(first).terms.user, "ada");
  EXPECT_EQ(cancel(*bob, first).error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_TRUE(cancel(*ada, first).ok());
  cluster_->start_worker(3);
  const JobStatus running =
      cluster_->wait_until(second, 30, [](const JobStatus& s) { return s.tasks_leased > 0; });
  EXPECT_EQ(running.tasks_leased, 1u) << "tasks=1";
  EXPECT_TRUE(cancel(*root, second).ok());
}

TEST_F(Security, AnOpenListenerNeedsThemOrSaysInsecure) {
  const std::string store = cluster_->path("open-store"), log = cluster_->path("open.log");
  const auto serve = [&](std::vector<std::string> flags) {
    std::vector<std::string> command = {PENUMBRA_SERVER, "--listen", "0.0.0.0:0", "--store", store};
    command.insert(command.end(), flags.begin(), flags.end());
    return std::make_unique<Process>(command, log);
  };
  EXPECT_EQ(serve({})->wait(20), 2);
  EXPECT_EQ(serve({"--tls-cert", file("server.pem"), "--tls-key", file("server-key.pem")})->wait(20), 2);
  EXPECT_NE(text_of(log).find("--insecure"), std::string::npos);
  const auto open = serve({"--insecure"});
  EXPECT_EQ(open->wait(2), std::nullopt) << text_of(log);
  open->signal(SIGTERM);
  EXPECT_EQ(open->wait(20), 0);
}

}  // namespace
}  // namespace penumbra
