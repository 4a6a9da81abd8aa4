#include "server/postgres.h"

#include <endian.h>

#include <cstring>

#include "proto/status.h"

namespace penumbra {
namespace {

// Results of statements that nobody reads fill the connection's buffers, until both sides wait for one
// another.
constexpr int kMostUnread = 256;

struct Clear {
  void operator()(PGresult* result) const { PQclear(result); }
};
using Result = std::unique_ptr<PGresult, Clear>;

bool good(const Result& result) {
  const ExecStatusType status = PQresultStatus(result.get());
  return status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK;
}

struct Pointers {
  std::vector<const char*> values;
  std::vector<int> lengths;
};

Pointers pointers_of(const std::vector<std::string>& values) {
  Pointers out;
  for (const std::string& value : values) {
    out.values.push_back(value.data());
    out.lengths.push_back(static_cast<int>(value.size()));
  }
  return out;
}

}  // namespace

PgParameters& PgParameters::bytes(std::string_view value) {
  values_.emplace_back(value);
  binary_.push_back(1);
  return *this;
}

PgParameters& PgParameters::number(uint64_t value) {
  values_.push_back(fmt::format("{}", value));
  binary_.push_back(0);
  return *this;
}

std::string PgRows::bytes(int row, int column) const {
  return {PQgetvalue(result_.get(), row, column),
          static_cast<size_t>(PQgetlength(result_.get(), row, column))};
}

uint64_t PgRows::number(int row, int column) const {
  PENUMBRA_CHECK(PQgetlength(result_.get(), row, column) == sizeof(uint64_t));
  uint64_t value = 0;
  std::memcpy(&value, PQgetvalue(result_.get(), row, column), sizeof value);
  return be64toh(value);
}

absl::Status PgStatements::error(std::string_view what) const {
  std::string message = PQerrorMessage(connection_);
  while (!message.empty() && message.back() == '\n') message.pop_back();
  return make_status(absl::StatusCode::kInternal, "job store: {}: {}", what, message);
}

absl::Status PgStatements::execute(const char* sql) {
  const Result result(PQexec(connection_, sql));
  return good(result) ? absl::OkStatus() : error(sql);
}

absl::StatusOr<PgRows> PgStatements::query(const char* sql, const PgParameters& parameters) {
  const Pointers p = pointers_of(parameters.values_);
  Result result(PQexecParams(connection_, sql, static_cast<int>(p.values.size()), nullptr, p.values.data(),
                             p.lengths.data(), parameters.binary_.data(), 1));
  if (!good(result)) return error(sql);
  return PgRows(result.release());
}

absl::Status PgStatements::prepare(const char* name, const char* sql) {
  const Result result(PQprepare(connection_, name, sql, 0, nullptr));
  return good(result) ? absl::OkStatus() : error(sql);
}

absl::Status PgStatements::send(const char* name, const PgParameters& parameters) {
  if (PQpipelineStatus(connection_) == PQ_PIPELINE_OFF && PQenterPipelineMode(connection_) == 0)
    return error(name);
  const Pointers p = pointers_of(parameters.values_);
  if (PQsendQueryPrepared(connection_, name, static_cast<int>(p.values.size()), p.values.data(),
                          p.lengths.data(), parameters.binary_.data(), 1) == 0)
    return error(name);
  return ++sent_ < kMostUnread ? absl::OkStatus() : collect();
}

/// One answer and one null for each statement, then the answer to the synchronisation.
absl::Status PgStatements::collect() {
  absl::Status first;
  if (PQpipelineSync(connection_) == 0) return error("sending");
  for (; sent_ > 0; --sent_) {
    const Result result(PQgetResult(connection_));
    if (result == nullptr) return error("the connection was lost");
    // After a failure the rest is skipped by the server: the first says why.
    if (!good(result) && first.ok()) first = error("writing");
    const Result after(PQgetResult(connection_));
    PENUMBRA_CHECK(after == nullptr || PQstatus(connection_) != CONNECTION_OK);
  }
  const Result end(PQgetResult(connection_));
  if (PQresultStatus(end.get()) != PGRES_PIPELINE_SYNC && first.ok()) first = error("writing");
  return first;
}

absl::Status PgStatements::finish_sent() {
  absl::Status status = sent_ > 0 ? collect() : absl::OkStatus();
  if (PQpipelineStatus(connection_) != PQ_PIPELINE_OFF && PQexitPipelineMode(connection_) == 0 && status.ok())
    status = error("writing");
  return status;
}

}  // namespace penumbra
