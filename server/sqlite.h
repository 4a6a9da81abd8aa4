#pragma once
// The little of SQLite's C interface that the store needs, with statuses instead of codes.
#include <sqlite3.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "proto/status.h"

namespace penumbra {

inline absl::Status sqlite_error(sqlite3* db, std::string_view what) {
  const int code = sqlite3_errcode(db);
  return make_status(code == SQLITE_FULL ? absl::StatusCode::kResourceExhausted : absl::StatusCode::kInternal,
                     "job store: {}: {}", what, sqlite3_errmsg(db));
}

/// A prepared statement; bind in order, then run() or step() through rows.
class Statement {
 public:
  static absl::StatusOr<Statement> prepare(sqlite3* db, std::string_view sql) {
    sqlite3_stmt* raw = nullptr;
    if (sqlite3_prepare_v2(db, sql.data(), static_cast<int>(sql.size()), &raw, nullptr) != SQLITE_OK)
      return sqlite_error(db, sql);
    return Statement(db, raw);
  }

  Statement& bind(std::string_view text) {
    sqlite3_bind_text64(raw_.get(), ++bound_, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
    return *this;
  }
  Statement& bind_blob(std::string_view bytes) {
    sqlite3_bind_blob64(raw_.get(), ++bound_, bytes.data(), bytes.size(), SQLITE_TRANSIENT);
    return *this;
  }
  Statement& bind(uint64_t value) {
    sqlite3_bind_int64(raw_.get(), ++bound_, static_cast<sqlite3_int64>(value));
    return *this;
  }

  /// Executes and makes ready for the next binding.
  absl::Status run() {
    const int code = sqlite3_step(raw_.get());
    const absl::Status status = code == SQLITE_DONE ? absl::OkStatus() : sqlite_error(db_, "writing");
    sqlite3_reset(raw_.get());
    bound_ = 0;
    return status;
  }

  /// True while there is a row.
  absl::StatusOr<bool> step() {
    const int code = sqlite3_step(raw_.get());
    if (code == SQLITE_ROW) return true;
    if (code == SQLITE_DONE) return false;
    return sqlite_error(db_, "reading");
  }
  std::string text(int column) {
    const void* bytes = sqlite3_column_blob(raw_.get(), column);
    const int size = sqlite3_column_bytes(raw_.get(), column);
    return bytes == nullptr ? std::string() : std::string(static_cast<const char*>(bytes), size);
  }
  uint64_t number(int column) { return static_cast<uint64_t>(sqlite3_column_int64(raw_.get(), column)); }

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  Statement(sqlite3* db, sqlite3_stmt* raw) : db_(db), raw_(raw) {}
  sqlite3* db_;
  std::unique_ptr<sqlite3_stmt, Finalize> raw_;
  int bound_ = 0;
};

inline absl::Status execute(sqlite3* db, const char* sql) {
  if (sqlite3_exec(db, sql, nullptr, nullptr, nullptr) != SQLITE_OK) return sqlite_error(db, sql);
  return absl::OkStatus();
}

}  // namespace penumbra
