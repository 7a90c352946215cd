/// Restricts SQLite, so that a database file from elsewhere cannot run code or change other files.
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "libstudy/store/file/sqlite.hpp"

namespace study::sqlite {

namespace {

// Limits for SQLite, far above the needs of a study: length of a value or row, and of a statement's SQL,
// bytes.
constexpr int longest_value = 1 << 26, longest_sql = 1 << 21;
constexpr int most_columns = 500, deepest_trigger = 8, most_attached = 2;
// Limit on the work with an untrusted file: operations per call of the progress handler, and number of calls.
// Their product, 10 million operations, is far more than reading the schema of vip-study takes.
constexpr int operations_a_step = 10'000, most_steps = 1'000;

bool is(const char* text, std::string_view other) { return text && text == other; }

/// True for SQL functions that load code or access files.
bool is_dangerous(const char* function) {
  constexpr std::array<std::string_view, 5> names{"load_extension", "readfile", "writefile", "edit",
                                                  "fts3_tokenizer"};
  return function && std::find(names.begin(), names.end(), function) != names.end();
}

bool only_reads(int action) {
  constexpr std::array actions{SQLITE_SELECT, SQLITE_READ,        SQLITE_FUNCTION, SQLITE_RECURSIVE,
                               SQLITE_PRAGMA, SQLITE_TRANSACTION, SQLITE_SAVEPOINT};
  return std::find(actions.begin(), actions.end(), action) != actions.end();
}

bool changes_schema(int action) {
  constexpr std::array actions{SQLITE_CREATE_INDEX, SQLITE_CREATE_TABLE,  SQLITE_CREATE_TRIGGER,
                               SQLITE_CREATE_VIEW,  SQLITE_CREATE_VTABLE, SQLITE_DROP_INDEX,
                               SQLITE_DROP_TABLE,   SQLITE_DROP_TRIGGER,  SQLITE_DROP_VIEW,
                               SQLITE_DROP_VTABLE,  SQLITE_ALTER_TABLE};
  return std::find(actions.begin(), actions.end(), action) != actions.end();
}

}  // namespace

void Connection::protect() {
  sqlite3_busy_handler(handle_, &Connection::wait, this);
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_limit(handle_, SQLITE_LIMIT_LENGTH, longest_value);
  sqlite3_limit(handle_, SQLITE_LIMIT_SQL_LENGTH, longest_sql);
  sqlite3_limit(handle_, SQLITE_LIMIT_COLUMN, most_columns);
  sqlite3_limit(handle_, SQLITE_LIMIT_TRIGGER_DEPTH, deepest_trigger);
  sqlite3_limit(handle_, SQLITE_LIMIT_ATTACHED, most_attached);
  sqlite3_exec(handle_, "PRAGMA cell_size_check = ON", nullptr, nullptr, nullptr);
  sqlite3_set_authorizer(handle_, &Connection::authorise, this);
}

void Connection::distrust(Work limit) {
  trust_ = Trust::Unknown;
  work_ = 0;
  if (limit == Work::OfASchema)
    sqlite3_progress_handler(handle_, operations_a_step, &Connection::grow_tired, this);
}

void Connection::recognise() {
  trust_ = Trust::Free;
  sqlite3_progress_handler(handle_, 0, nullptr, nullptr);
}

void Connection::seal() { trust_ = Trust::Sealed; }

int Connection::grow_tired(void* connection) {
  return ++static_cast<Connection*>(connection)->work_ > most_steps ? 1 : 0;
}

int Connection::authorise(void* connection, int action, const char* first, const char* second,
                          const char* schema, const char* inner) {
  const auto& self = *static_cast<const Connection*>(connection);
  return self.allows(action, first, second, schema, inner) ? SQLITE_OK : SQLITE_DENY;
}

bool Connection::allows(int action, const char* first, const char* second, const char* schema,
                        const char* inner) const {
  if (action == SQLITE_FUNCTION && is_dangerous(second)) return false;
  if (trust_ == Trust::Unknown) return only_reads(action) && !inner;
  if (trust_ == Trust::Free) return true;
  // VACUUM attaches a temporary file with an empty name.
  if (action == SQLITE_ATTACH) return is(first, "");
  return !changes_schema(action) || !is(action == SQLITE_ALTER_TABLE ? first : schema, "main");
}

}  // namespace study::sqlite
