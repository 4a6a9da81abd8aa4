#pragma once
// The little of libpq that the store needs, with statuses instead of codes.
#include <libpq-fe.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace penumbra {

struct FinishConnection {
  void operator()(PGconn* connection) const { PQfinish(connection); }
};
using PgConnection = std::unique_ptr<PGconn, FinishConnection>;

/// Parameters of one statement. Texts and bytes travel as they are (columns are BYTEA: names of files and
/// hosts need not be UTF-8), numbers as decimal text.
class PgParameters {
 public:
  PgParameters& bytes(std::string_view value);
  PgParameters& number(uint64_t value);

 private:
  friend class PgStatements;
  std::vector<std::string> values_;
  std::vector<int> binary_;
};

/// Rows with columns in PostgreSQL's binary format: BYTEA and BIGINT.
class PgRows {
 public:
  explicit PgRows(PGresult* result) : result_(result) {}
  int count() const { return PQntuples(result_.get()); }
  std::string bytes(int row, int column) const;
  uint64_t number(int row, int column) const;

 private:
  struct Clear {
    void operator()(PGresult* result) const { PQclear(result); }
  };
  std::unique_ptr<PGresult, Clear> result_;
};

/// Statements of one connection. Errors are Internal, with PostgreSQL's message.
class PgStatements {
 public:
  explicit PgStatements(PGconn* connection) : connection_(connection) {}

  /// Without parameters and rows.
  absl::Status execute(const char* sql);
  absl::StatusOr<PgRows> query(const char* sql, const PgParameters& parameters = {});
  absl::Status prepare(const char* name, const char* sql);

  /// Sends a prepared statement without waiting for its end (libpq's pipeline mode, entered by the first).
  absl::Status send(const char* name, const PgParameters& parameters);
  /// Waits for all that was sent; the first error. Leaves pipeline mode.
  absl::Status finish_sent();

 private:
  absl::Status error(std::string_view what) const;
  absl::Status collect();
  PGconn* connection_;
  int sent_ = 0;
};

}  // namespace penumbra
