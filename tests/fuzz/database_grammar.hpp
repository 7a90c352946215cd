#pragma once
/// Generates SQL that spoils a study's database from a stream of choices: tables, columns, views, triggers,
/// indexes and rows, valid and invalid. The same bytes give the same SQL.

#include <sqlite3.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace fuzz {

/// Bytes as choices; after the last byte, every choice is the first option.
class Choices {
 public:
  Choices(const std::uint8_t* bytes, std::size_t size) : at_(bytes), end_(bytes + size) {}
  std::size_t below(std::size_t count) { return at_ == end_ ? 0 : *at_++ % count; }
  template <std::size_t N>
  const char* one_of(const std::array<const char*, N>& list) {
    return list[below(N)];
  }
  bool empty() const { return at_ == end_; }

 private:
  const std::uint8_t *at_, *end_;
};

class Grammar {
 public:
  explicit Grammar(Choices& choices) : pick_(choices) {}

  std::string statement() {
    switch (pick_.below(14)) {
      case 0:
        return "CREATE TABLE " + name() + " (" + columns() + ")" +
               pick_.one_of(std::array{"", " STRICT", " WITHOUT ROWID"});
      case 1:
        return "CREATE TABLE " + name() + " AS " + select();
      case 2:
        return "CREATE VIEW " + name() + " AS " + select();
      case 3:
        return "PRAGMA foreign_keys = OFF; DROP TABLE " + table() + "; CREATE VIEW " + table() + " AS " +
               select();
      case 4:
        return "CREATE TRIGGER " + name() + pick_.one_of(std::array{" BEFORE ", " AFTER ", " INSTEAD OF "}) +
               pick_.one_of(std::array{"INSERT", "UPDATE", "DELETE"}) + " ON " + table() + " BEGIN " +
               change() + "; END";
      case 5:
        return std::string("CREATE ") + pick_.one_of(std::array{"", "UNIQUE "}) + "INDEX " + name() + " ON " +
               table() + " (" + expression(2) + ")" + (pick_.below(2) ? " WHERE " + expression(1) : "");
      case 6:
        return "ALTER TABLE " + table() + " ADD COLUMN " + column();
      case 7:
        return "ALTER TABLE " + table() + pick_.one_of(std::array{" DROP COLUMN ", " RENAME TO "}) + name();
      case 8:
        return "PRAGMA writable_schema = ON; " + schema_change() + "; PRAGMA writable_schema = RESET";
      case 9:
        return pick_.one_of(std::array{
            "PRAGMA application_id = 1", "PRAGMA user_version = 3", "PRAGMA user_version = 99",
            "PRAGMA schema_version = 9", "PRAGMA journal_mode = DELETE; PRAGMA page_size = 512; VACUUM",
            "PRAGMA journal_mode = DELETE", "PRAGMA auto_vacuum = FULL; VACUUM", "ANALYZE", "REINDEX"});
      case 10:
        return "CREATE VIRTUAL TABLE " + name() + " USING " +
               pick_.one_of(
                   std::array{"rtree(id, a, b)", "fts5(words)", "fts4(words)", "dbstat", "nothing(a)"});
      default:
        return change();
    }
  }

 private:
  std::string table() {
    return pick_.one_of(std::array{"response",
                                   "session",
                                   "trial",
                                   "unit",
                                   "presentation",
                                   "frame",
                                   "gaze",
                                   "event",
                                   "protocol",
                                   "question",
                                   "run",
                                   "tombstone",
                                   "permission_change",
                                   "note",
                                   "chore",
                                   "export",
                                   "export_person",
                                   "cell",
                                   "ask",
                                   "framing",
                                   "answer",
                                   "sharing"});
  }
  std::string name() {
    return pick_.one_of(std::array{"extra", "response", "tombstone", "\"a b\"", "\"x'); DROP TABLE run --\"",
                                   "\"\x1b[2J\"", "\"../../out\"", "words", "score", "person", "path"});
  }
  std::string column_of_ours() {
    return pick_.one_of(std::array{"session_id",  "unit_id", "trial_id",    "presentation_id",
                                   "protocol_id", "run_id",  "question_id", "score",
                                   "words",       "person",  "participant", "code",
                                   "station",     "path",    "host",        "kind",
                                   "sha256",      "text",    "name",        "detail",
                                   "utc",         "state",   "attempt",     "position",
                                   "options",     "uid",     "granted"});
  }
  std::string value() {
    return pick_.one_of(std::array{"NULL", "0", "-1", "7", "9223372036854775807", "1e308", "-9e999", "''",
                                   "'P01'", "x'00ff'", "'a' || char(0) || 'b'", "char(27) || '[2J'",
                                   "'../../../out'", "'/etc/passwd'", "zeroblob(100000)",
                                   "hex(zeroblob(300000))", "replace(hex(zeroblob(20000)), '0', '[')",
                                   "'\xff\xfe'", "'2026-01-01T00:00:00Z'"});
  }
  std::string expression(int depth) {
    if (depth == 0) return pick_.below(2) ? value() : column_of_ours();
    switch (pick_.below(4)) {
      case 0:
        return "(" + expression(depth - 1) + pick_.one_of(std::array{" || ", " + ", " = ", " AND "}) +
               expression(depth - 1) + ")";
      case 1:
        return pick_.one_of(
                   std::array{"length(", "hex(", "abs(", "upper(", "randomblob(", "load_extension("}) +
               expression(depth - 1) + ")";
      default:
        return expression(0);
    }
  }
  std::string column() {
    return name() + pick_.one_of(std::array{" INTEGER", " TEXT", " REAL", " ANY", "", " BLOB"}) +
           (pick_.below(3) == 0 ? " AS (" + expression(2) + ")" : "") +
           (pick_.below(3) == 0 ? " CHECK (" + expression(1) + ")" : "");
  }
  std::string columns() {
    std::string list = column();
    for (std::size_t i = pick_.below(3); i > 0; --i) list += ", " + column();
    return list;
  }
  std::string select() {
    constexpr const char* endless = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n";
    switch (pick_.below(4)) {
      case 0:
        return std::string(endless) + ") SELECT i AS " + column_of_ours() + " FROM n";
      case 1:
        return std::string(endless) + " LIMIT 50) SELECT i, i FROM n";
      case 2:
        return "SELECT " + expression(2) + " AS " + column_of_ours();
      default:
        return std::string("SELECT * FROM ") + table();
    }
  }
  std::string change() {
    switch (pick_.below(5)) {
      case 0:
        return std::string("DELETE FROM ") + table() + (pick_.below(2) ? " WHERE rowid % 2" : "");
      case 1:
        return "INSERT OR REPLACE INTO tombstone VALUES (" + value() + ", 'P01', 'P01', " + value() + ", " +
               value() + ")";
      case 2:
        return "INSERT OR REPLACE INTO permission_change (session_id, utc, granted, what) VALUES (1, " +
               value() + ", " + value() + ", 'gaze')";
      default:
        return std::string("UPDATE OR IGNORE ") + table() + " SET " + column_of_ours() + " = " + value() +
               (pick_.below(2) ? " WHERE rowid = 1" : "");
    }
  }
  std::string schema_change() {
    const std::string where = std::string(" WHERE name = '") + table() + "'";
    switch (pick_.below(6)) {
      case 0:
        return "UPDATE sqlite_schema SET sql = replace(sql, 'NOT NULL', '')" + where;
      case 1:
        return "UPDATE sqlite_schema SET sql = replace(sql, 'STRICT', '')" + where;
      case 2:
        return "UPDATE sqlite_schema SET rootpage = " + std::to_string(pick_.below(60)) + where;
      case 3:
        return "UPDATE sqlite_schema SET " +
               std::string(pick_.one_of(std::array{"type", "tbl_name", "name", "sql"})) + " = " + value() +
               where;
      case 4:
        return "DELETE FROM sqlite_schema" + where;
      default:
        return "INSERT INTO sqlite_schema VALUES ('view', 'extra', 'extra', 0, 'CREATE VIEW extra AS SELECT "
               "1')";
    }
  }

  Choices& pick_;
};

/// The statements that the bytes choose.
inline std::vector<std::string> statements_of(const std::uint8_t* bytes, std::size_t size,
                                              std::size_t most = 12) {
  Choices choices(bytes, size);
  Grammar grammar(choices);
  std::vector<std::string> all;
  while (!choices.empty() && all.size() < most) all.push_back(grammar.statement());
  return all;
}

/// Runs the statements without any checks, and ignores failures.
inline void spoil(const std::filesystem::path& path, const std::vector<std::string>& statements) {
  sqlite3* database = nullptr;
  sqlite3_open_v2(path.c_str(), &database, SQLITE_OPEN_READWRITE, nullptr);
  int work = 0;
  sqlite3_progress_handler(
      database, 1000, [](void* done) { return ++*static_cast<int*>(done) > 2000 ? 1 : 0; }, &work);
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, 1 << 22);
  sqlite3_exec(database, "PRAGMA ignore_check_constraints = ON; PRAGMA synchronous = OFF", nullptr, nullptr,
               nullptr);
  for (const std::string& statement : statements) {
    work = 0;
    sqlite3_exec(database, statement.c_str(), nullptr, nullptr, nullptr);
  }
  sqlite3_close(database);
}

}  // namespace fuzz
