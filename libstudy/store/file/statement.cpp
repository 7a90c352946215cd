#include <sqlite3.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "libstudy/store/file/sqlite.hpp"

namespace study::sqlite {

Statement::Statement(Connection& connection, std::string_view sql) : connection_(&connection) {
  connection.check(sqlite3_prepare_v3(connection.handle(), sql.data(), static_cast<int>(sql.size()),
                                      SQLITE_PREPARE_PERSISTENT, &handle_, nullptr));
}

Statement::~Statement() { sqlite3_finalize(handle_); }

Statement::Statement(Statement&& other) noexcept
    : connection_(other.connection_), handle_(std::exchange(other.handle_, nullptr)) {}

Statement& Statement::bind_at(int index, std::int64_t value) {
  connection_->check(sqlite3_bind_int64(handle_, index + 1, value));
  return *this;
}

Statement& Statement::bind_at(int index, double value) {
  if (std::isnan(value)) return bind_at(index, std::nullopt);
  connection_->check(sqlite3_bind_double(handle_, index + 1, value));
  return *this;
}

Statement& Statement::bind_at(int index, std::string_view value) {
  connection_->check(sqlite3_bind_text(handle_, index + 1, value.data() ? value.data() : "",
                                       static_cast<int>(value.size()), SQLITE_TRANSIENT));
  return *this;
}

Statement& Statement::bind_at(int index, Blob value) {
  connection_->check(sqlite3_bind_blob64(handle_, index + 1, value.bytes.data() ? value.bytes.data() : "",
                                         value.bytes.size(), SQLITE_TRANSIENT));
  return *this;
}

Statement& Statement::bind_at(int index, std::nullopt_t) {
  connection_->check(sqlite3_bind_null(handle_, index + 1));
  return *this;
}

Statement& Statement::bind_from(int index, const Statement& row, int column) {
  connection_->check(sqlite3_bind_value(handle_, index + 1, sqlite3_column_value(row.handle_, column)));
  return *this;
}

void Statement::expect_parameters(std::size_t given) const {
  const auto wanted = static_cast<std::size_t>(sqlite3_bind_parameter_count(handle_));
  if (given == wanted) return;
  throw std::logic_error("Statement::bind_all(): " + std::to_string(given) + " values for the " +
                         std::to_string(wanted) + " parameters of: " + sqlite3_sql(handle_) +
                         "; pass one value for each parameter");
}

bool Statement::step() {
  const int code = sqlite3_step(handle_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) {
    sqlite3_reset(handle_);
    return false;
  }
  try {
    connection_->check(code);
  } catch (...) {
    sqlite3_reset(handle_);
    throw;
  }
  return false;
}

std::int64_t Statement::run() {
  while (step()) {
  }
  return connection_->last_row_id();
}

void Statement::reset() { sqlite3_reset(handle_); }

int Statement::columns() const { return sqlite3_column_count(handle_); }

std::string Statement::column_name(int index) const { return sqlite3_column_name(handle_, index); }

bool Statement::is_null(int index) const { return sqlite3_column_type(handle_, index) == SQLITE_NULL; }

bool Statement::is_real(int index) const { return sqlite3_column_type(handle_, index) == SQLITE_FLOAT; }

bool Statement::is_text(int index) const { return sqlite3_column_type(handle_, index) == SQLITE_TEXT; }

std::int64_t Statement::integer(int index) const { return sqlite3_column_int64(handle_, index); }

double Statement::real(int index) const { return sqlite3_column_double(handle_, index); }

std::string Statement::text(int index) const {
  const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(handle_, index));
  return bytes ? std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(handle_, index)))
               : std::string();
}

std::string Statement::blob(int index) const {
  const auto* bytes = static_cast<const char*>(sqlite3_column_blob(handle_, index));
  return bytes ? std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(handle_, index)))
               : std::string();
}

}  // namespace study::sqlite
