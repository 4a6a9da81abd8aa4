#include "client/server.h"

#include <unistd.h>

#include <fstream>
#include <random>

#include "client/frames.h"
#include "client/retry.h"
#include "proto/blobs.grpc.pb.h"
#include "proto/channel.h"
#include "proto/convert.h"
#include "proto/render.grpc.pb.h"
#include "proto/rpc_status.h"

namespace penumbra {
namespace {

constexpr std::chrono::seconds kUnaryDeadline{30};
constexpr std::chrono::seconds kNoDeadline{0};

/// 128 random bits in hexadecimal: names a Submit, so that repeating it is harmless.
std::string random_id() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}{:08x}{:08x}", random(), random(), random(), random());
}

v1::JobRequest request_for(const JobId& job) {
  v1::JobRequest request;
  request.set_job(job);
  return request;
}

}  // namespace

struct Server::Parts {
  std::string address;
  Check check;
  std::unique_ptr<v1::Render::Stub> render;
  std::unique_ptr<v1::Blobs::Stub> blobs;

  Retry retry(const std::stop_token& stop) const { return {address, check, stop}; }

  /// A unary call of either service.
  template <class Response, class Stub, class Request>
  absl::StatusOr<Response> unary(Stub& stub,
                                 grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&,
                                                              Response*),
                                 const Request& request, const std::stop_token& stop) {
    Response response;
    RETURN_IF_ERROR(
        call_with_retries(retry(stop), stop, kUnaryDeadline, [&](grpc::ClientContext& context, Retry&) {
          response.Clear();
          return (stub.*method)(&context, request, &response);
        }));
    return response;
  }

  absl::Status upload_blob(const Digest& digest, uint64_t partial,
                           const std::function<bool(uint64_t, std::string&)>& read, uint64_t size,
                           const std::stop_token& stop, const std::function<void(uint64_t)>& sent);
  absl::StatusOr<std::vector<v1::FindMissingResponse::Missing>> missing(const std::vector<Digest>& digests,
                                                                        const std::stop_token& stop);
};

Server::Server(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Server::Server(Server&&) noexcept = default;
Server::~Server() = default;

absl::StatusOr<Server> Server::open(const std::string& address, const Credentials& credentials, Check check) {
  if (address.empty()) return invalid_input("--server HOST:PORT (or PENUMBRA_SERVER) is missing");
  ASSIGN_OR_RETURN(const std::shared_ptr<grpc::Channel> channel, open_channel(address, credentials));
  auto parts = std::make_unique<Parts>();
  parts->address = address;
  parts->check = std::move(check);
  parts->render = v1::Render::NewStub(channel);
  parts->blobs = v1::Blobs::NewStub(channel);
  return Server(std::move(parts));
}

absl::StatusOr<JobId> Server::submit(const JobSpec& spec, std::stop_token stop, const JobTerms& terms) {
  v1::SubmitRequest request;
  *request.mutable_spec() = to_proto(spec);
  *request.mutable_terms() = to_proto(terms);
  request.set_request_id(random_id());
  ASSIGN_OR_RETURN(const v1::SubmitResponse response,
                   parts_->unary(*parts_->render, &v1::Render::Stub::Submit, request, stop));
  return response.job();
}

absl::StatusOr<JobStatus> Server::status(const JobId& job, std::stop_token stop) {
  ASSIGN_OR_RETURN(const v1::JobStatus status,
                   parts_->unary(*parts_->render, &v1::Render::Stub::GetJob, request_for(job), stop));
  return from_proto(status);
}

absl::StatusOr<JobStatus> Server::cancel(const JobId& job) {
  ASSIGN_OR_RETURN(const v1::JobStatus status, parts_->unary(*parts_->render, &v1::Render::Stub::Cancel,
                                                             request_for(job), std::stop_token()));
  return from_proto(status);
}

absl::StatusOr<std::vector<JobStatus>> Server::jobs(std::stop_token stop) {
  ASSIGN_OR_RETURN(const v1::ListJobsResponse response,
                   parts_->unary(*parts_->render, &v1::Render::Stub::ListJobs, v1::ListJobsRequest(), stop));
  std::vector<JobStatus> jobs;
  for (const v1::JobStatus& message : response.jobs()) {
    ASSIGN_OR_RETURN(JobStatus status, from_proto(message));
    jobs.push_back(std::move(status));
  }
  return jobs;
}

absl::StatusOr<std::vector<std::string>> Server::explain(const JobId& job, std::stop_token stop) {
  ASSIGN_OR_RETURN(const v1::ExplainResponse response,
                   parts_->unary(*parts_->render, &v1::Render::Stub::Explain, request_for(job), stop));
  return std::vector<std::string>(response.reasons().begin(), response.reasons().end());
}

absl::StatusOr<std::vector<LogLine>> Server::log(const JobId& job, std::optional<uint64_t> tile,
                                                 bool worker_lines, std::stop_token stop) {
  v1::LogRequest request;
  request.set_job(job);
  if (tile) request.set_tile(*tile);
  request.set_worker_lines(worker_lines);
  ASSIGN_OR_RETURN(const v1::LogResponse response,
                   parts_->unary(*parts_->render, &v1::Render::Stub::Log, request, stop));
  std::vector<LogLine> lines;
  for (const v1::LogResponse::Line& message : response.lines()) {
    ASSIGN_OR_RETURN(LogLine line, from_proto(message));
    lines.push_back(std::move(line));
  }
  return lines;
}

absl::StatusOr<JobStatus> Server::watch(const JobId& job, std::stop_token stop, const EachStatus& each) {
  JobStatus last;
  absl::Status ended;  // by `each`, or a message that is not understood
  const auto follow = [&](grpc::ClientContext& context, Retry& retry) {
    const auto stream = parts_->render->Watch(&context, request_for(job));
    for (v1::JobStatus message; ended.ok() && stream->Read(&message);) {
      retry.answered();
      absl::StatusOr<JobStatus> status = from_proto(message);
      ended = status.status();
      if (!ended.ok()) break;
      last = *std::move(status);
      ended = each(last);
    }
    if (!ended.ok()) context.TryCancel();
    const grpc::Status closed = stream->Finish();
    if (!ended.ok()) return grpc::Status::OK;
    // A stream that ends well before the job does was cut off by a server that is going away.
    if (closed.ok() && !is_final(last.state))
      return grpc::Status(grpc::StatusCode::UNAVAILABLE, "the server closed the stream");
    return closed;
  };
  RETURN_IF_ERROR(call_with_retries(parts_->retry(stop), stop, kNoDeadline, follow));
  RETURN_IF_ERROR(ended);
  return last;
}

absl::StatusOr<RunSummary> Server::summary(const JobId& job, std::stop_token stop) {
  v1::FetchFramesRequest request;
  request.set_job(job);
  request.set_summary_only(true);
  v1::RunSummary summary;
  const auto receive = [&](grpc::ClientContext& context, Retry& retry) {
    summary.Clear();
    const auto stream = parts_->render->FetchFrames(&context, request);
    for (v1::FetchFramesResponse message; stream->Read(&message);) {
      retry.answered();
      if (message.has_summary()) summary.MergeFrom(message.summary());
    }
    return stream->Finish();
  };
  RETURN_IF_ERROR(call_with_retries(parts_->retry(stop), stop, kNoDeadline, receive));
  return from_proto(summary);
}

absl::StatusOr<FetchedRun> Server::fetch(const JobId& job, std::stop_token stop, const EachCheckpoint& each) {
  FetchedRun run;
  absl::Status ended;
  v1::FetchFramesRequest request;
  request.set_job(job);
  request.set_checkpoints(static_cast<bool>(each));
  v1::RunSummary summary;
  const auto take = [&](const v1::FetchFramesResponse& message,
                        std::optional<FrameAssembler>& assembler) -> absl::Status {
    if (message.has_summary()) {
      summary.MergeFrom(message.summary());
      return absl::OkStatus();
    }
    if (!assembler) {  // the summary is whole
      ASSIGN_OR_RETURN(run.summary, from_proto(summary));
      const JobSpec& spec = run.summary.spec;
      run.images.assign(spec.mixes.size(), {});
      run.bins.assign(spec.mixes.size(),
                      std::vector<FilmImage>(spec.transient ? size_t(spec.transient->bins) : 0));
      assembler.emplace(run.summary.spec);
    }
    if (message.has_frame()) {
      ASSIGN_OR_RETURN(std::optional<ArrivedFrame> frame, assembler->add(message.frame()));
      if (!frame) return absl::OkStatus();
      const auto mix = static_cast<size_t>(frame->mix);
      if (frame->bin > 0) {
        run.bins[mix][static_cast<size_t>(frame->bin) - 1] = std::move(frame->image);
        return absl::OkStatus();
      }
      if (each) each(run.summary, frame->mix, frame->checkpoint, frame->image);
      if (frame->final) run.images[mix] = std::move(frame->image);
    } else if (message.has_end()) {
      run.scheduler_cpu_seconds = message.end().scheduler_cpu_seconds();
    }
    return absl::OkStatus();
  };
  const auto receive = [&](grpc::ClientContext& context, Retry& retry) {
    std::optional<FrameAssembler> assembler;
    bool whole = false;
    summary.Clear();
    const auto stream = parts_->render->FetchFrames(&context, request);
    for (v1::FetchFramesResponse message; ended.ok() && stream->Read(&message);) {
      retry.answered();
      ended = take(message, assembler);
      whole = message.has_end();
    }
    if (!ended.ok()) context.TryCancel();
    const grpc::Status closed = stream->Finish();
    if (!ended.ok()) return grpc::Status::OK;
    if (closed.ok() && !whole) return grpc::Status(grpc::StatusCode::UNAVAILABLE, "the frames were cut off");
    return closed;
  };
  RETURN_IF_ERROR(call_with_retries(parts_->retry(stop), stop, kNoDeadline, receive));
  RETURN_IF_ERROR(ended);
  return run;
}

absl::StatusOr<std::vector<v1::FindMissingResponse::Missing>> Server::Parts::missing(
    const std::vector<Digest>& digests, const std::stop_token& stop) {
  constexpr size_t kMostInOneRequest = 100'000;
  std::vector<v1::FindMissingResponse::Missing> out;
  for (size_t begin = 0; begin < digests.size(); begin += kMostInOneRequest) {
    v1::FindMissingRequest request;
    for (size_t i = begin; i < std::min(digests.size(), begin + kMostInOneRequest); ++i)
      request.add_digests(digests[i]);
    ASSIGN_OR_RETURN(const v1::FindMissingResponse response,
                     unary(*blobs, &v1::Blobs::Stub::FindMissing, request, stop));
    out.insert(out.end(), response.missing().begin(), response.missing().end());
  }
  return out;
}

absl::Status Server::Parts::upload_blob(const Digest& digest, uint64_t partial,
                                        const std::function<bool(uint64_t, std::string&)>& read,
                                        uint64_t size, const std::stop_token& stop,
                                        const std::function<void(uint64_t)>& sent) {
  absl::Status unreadable;
  const auto send = [&](grpc::ClientContext& context, Retry& retry) {
    v1::UploadResponse response;
    const auto stream = blobs->Upload(&context, &response);
    uint64_t offset = partial;
    v1::UploadChunk chunk;
    chunk.set_digest(digest);
    chunk.set_size(size);
    chunk.set_offset(offset);
    do {
      chunk.mutable_data()->resize(std::min<uint64_t>(kChunkBytes, size - offset));
      if (!read(offset, *chunk.mutable_data())) {
        unreadable = absl::DataLossError("changed or became unreadable while it was uploaded");
        context.TryCancel();
        break;
      }
      offset += chunk.data().size();
      if (!stream->Write(chunk)) break;  // Finish says why
      retry.answered();
      if (sent) sent(offset);
      chunk.Clear();
    } while (offset < size);
    stream->WritesDone();
    const grpc::Status status = stream->Finish();
    partial = 0;  // a second attempt starts from the beginning: what was kept is unknown by now
    return unreadable.ok() ? status : grpc::Status::OK;
  };
  RETURN_IF_ERROR(call_with_retries(retry(stop), stop, kNoDeadline, send));
  return unreadable;
}

absl::Status Server::upload(const LocalBundle& bundle, std::stop_token stop,
                            const std::function<void(uint64_t, uint64_t)>& progress) {
  const std::string index = serialize(bundle.index);
  const Digest index_digest = sha256(index);
  std::map<Digest, size_t> entries;  // of several entries with the same content one is sent
  std::vector<Digest> digests;
  for (size_t i = 0; i < bundle.index.entries.size(); ++i)
    if (entries.emplace(bundle.index.entries[i].digest, i).second)
      digests.push_back(bundle.index.entries[i].digest);
  digests.push_back(index_digest);
  ASSIGN_OR_RETURN(const auto missing, parts_->missing(digests, stop));

  uint64_t total = 0, done = 0;
  for (const auto& blob : missing)
    if (blob.digest() != index_digest)
      total += bundle.index.entries[entries.at(blob.digest())].size - blob.partial();
  for (const auto& blob : missing) {
    if (blob.digest() == index_digest) continue;
    const size_t i = entries.at(blob.digest());
    const uint64_t size = bundle.index.entries[i].size;
    std::ifstream file(bundle.paths[i], std::ios::binary);
    const auto read = [&](uint64_t offset, std::string& data) {
      file.clear();
      file.seekg(static_cast<std::streamoff>(offset));
      file.read(data.data(), static_cast<std::streamsize>(data.size()));
      return file.gcount() == static_cast<std::streamsize>(data.size());
    };
    const auto sent = [&](uint64_t offset) {
      if (progress) progress(done + offset - std::min(offset, blob.partial()), total);
    };
    const absl::Status status = parts_->upload_blob(blob.digest(), blob.partial(), read, size, stop, sent);
    if (!status.ok()) return make_status(status.code(), "{}: {}", bundle.paths[i], message_of(status));
    done += size - blob.partial();
  }
  // The index last: who has the index has the bundle.
  const auto read = [&](uint64_t offset, std::string& data) {
    data = index.substr(offset, data.size());
    return true;
  };
  if (std::none_of(missing.begin(), missing.end(), [&](const auto& m) { return m.digest() == index_digest; }))
    return absl::OkStatus();
  return parts_->upload_blob(index_digest, 0, read, index.size(), stop, {});
}

}  // namespace penumbra
