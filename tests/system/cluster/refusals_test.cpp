// What the server refuses, and how it says so.
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>

#include "proto/convert.h"
#include "proto/sync.h"
#include "tests/system/cluster/calm.h"

namespace penumbra {
namespace {

grpc::Status submit(Cluster& cluster, const JobSpec& spec) {
  v1::SubmitRequest request;
  *request.mutable_spec() = to_proto(spec);
  request.set_request_id("r");
  grpc::ClientContext context;
  v1::SubmitResponse response;
  return cluster.render().Submit(&context, request, &response);
}

TEST(Refusals, BlobsWithWrongDigestsOrNames) {
  Cluster cluster(test_name());
  cluster.start_server();
  EXPECT_EQ(cluster.upload(sha256("a"), "b").error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(cluster.upload("../../escape", "b").error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_TRUE(cluster.upload(sha256("a"), "a").ok());
  v1::FindMissingRequest request;
  for (const Digest& digest : {sha256("a"), sha256("c"), sha256("c")}) request.add_digests(digest);
  grpc::ClientContext context;
  v1::FindMissingResponse response;
  ASSERT_TRUE(cluster.blobs().FindMissing(&context, request, &response).ok());
  ASSERT_EQ(response.missing_size(), 1);
  EXPECT_EQ(response.missing(0).digest(), sha256("c"));
}

TEST(Refusals, BundlesThatEscapeOrAreNotThere) {
  Cluster cluster(test_name());
  cluster.start_server();
  EXPECT_EQ(submit(cluster, cluster.spec(Digest(64, 'a'))).error_code(),
            grpc::StatusCode::FAILED_PRECONDITION);
  const Digest good = cluster.upload_scene("0");
  grpc::ClientContext context;
  v1::DownloadRequest request;
  request.set_digest(good);
  const auto reader = cluster.blobs().Download(&context, request);
  v1::DownloadChunk chunk;
  std::string json;
  while (reader->Read(&chunk)) json += chunk.data();
  ASSERT_TRUE(reader->Finish().ok());
  for (const std::string& name :
       {std::string("../scene.pbrt"), std::string("/etc/passwd"), std::string("a/../../b")}) {
    std::string escaping = json;
    for (size_t at = 0; (at = escaping.find("scene.pbrt", at)) != std::string::npos; at += name.size())
      escaping.replace(at, 10, name);
    ASSERT_NE(escaping, json);
    ASSERT_TRUE(cluster.upload(sha256(escaping), escaping).ok());
    EXPECT_EQ(submit(cluster, cluster.spec(sha256(escaping))).error_code(),
              grpc::StatusCode::INVALID_ARGUMENT)
        << name;
  }
}

TEST(Refusals, JobsOutOfRangeAndUnknownJobs) {
  Cluster cluster(test_name());
  cluster.start_server();
  JobSpec spec = cluster.spec(cluster.upload_scene("0"));
  spec.width = 0;
  EXPECT_EQ(submit(cluster, spec).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  v1::JobRequest request;
  request.set_job("nonsense");
  grpc::ClientContext context;
  v1::JobStatus response;
  EXPECT_EQ(cluster.render().GetJob(&context, request, &response).error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST(Refusals, LateAndRepeatedResultsAreAcknowledgedAndThrownAway) {
  Cluster cluster(test_name());
  cluster.start_server();
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("0")));
  v1::SyncRequest state;
  state.set_protocol(kSyncProtocol);
  state.set_name("by-hand");
  *state.mutable_worker() = to_proto(WorkerInfo{"incarnation-1", "host", "avx2", 1});
  auto* completed = state.add_completed();
  completed->mutable_lease()->set_job(job);
  completed->mutable_lease()->set_epoch(1);
  completed->set_result(sha256("never uploaded"));
  for (int i = 0; i < 2; ++i) {
    grpc::ClientContext context;
    v1::SyncResponse response;
    ASSERT_TRUE(cluster.workers_stub().Sync(&context, state, &response).ok());
    EXPECT_EQ(response.acknowledged_size(), 1);
    EXPECT_EQ(response.leases_size(), 0);
  }
  EXPECT_EQ(cluster.status(job).tasks_done, 0u);
  state.set_protocol(99);
  grpc::ClientContext context;
  v1::SyncResponse response;
  EXPECT_EQ(cluster.workers_stub().Sync(&context, state, &response).error_code(),
            grpc::StatusCode::FAILED_PRECONDITION);
}

TEST(Refusals, APortInUseAndAStoreInUse) {
  Cluster cluster(test_name());
  cluster.start_server();
  Process port({PENUMBRA_SERVER, "--listen", cluster.address(), "--store", cluster.path("other")},
               cluster.path("port.log"));
  EXPECT_EQ(port.wait(20), 2);
  std::ifstream in(cluster.path("port.log"));
  const std::string log((std::istreambuf_iterator<char>(in)), {});
  EXPECT_NE(log.find("--listen " + cluster.address()), std::string::npos) << log;
  Process store({PENUMBRA_SERVER, "--listen", "127.0.0.1:0", "--store", cluster.path("store")},
                cluster.path("store.log"));
  EXPECT_EQ(store.wait(20), 2);
}

TEST(Refusals, AnOpenListenerWithoutTlsAndToken) {
  Cluster cluster(test_name());
  Process open({PENUMBRA_SERVER, "--listen", "0.0.0.0:0", "--store", cluster.path("store")},
               cluster.path("log"));
  EXPECT_EQ(open.wait(20), 2);
}

TEST(Refusals, ProgramsStopCleanlyAndKnowTheirFlags) {
  Cluster cluster(test_name());
  cluster.start_server();
  Process& worker = cluster.start_worker();
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("0")));
  cluster.wait_end(job);  // by now the worker is up
  v1::ListJobsResponse response;
  grpc::ClientContext context;
  EXPECT_TRUE(cluster.render().ListJobs(&context, {}, &response).ok());
  EXPECT_EQ(response.jobs_size(), 1);
  worker.signal(SIGTERM);
  EXPECT_EQ(worker.wait(10), 0);
  cluster.server().signal(SIGTERM);
  EXPECT_EQ(cluster.server().wait(10), 0);
  for (const char* program : {PENUMBRA_SERVER, PENUMBRA_FAKE_WORKER}) {
    for (const char* flag : {"--help", "--version"})
      EXPECT_EQ(Process({program, flag}, cluster.path("flags.log")).wait(10), 0) << program << flag;
    EXPECT_EQ(Process({program, "--bogus"}, cluster.path("flags.log")).wait(10), 2) << program;
  }
}

}  // namespace
}  // namespace penumbra
