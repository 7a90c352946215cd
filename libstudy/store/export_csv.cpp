#include "libstudy/store/export_csv.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "libstudy/store/database.hpp"
#include "libstudy/store/rating_table.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Statement;

namespace {

struct Table {
  const char* name;   // in the schema
  const char* file;   // of the export
  const char* order;  // makes equal databases equal files
};

constexpr std::array tables{
    Table{"protocol", "protocols.csv", "protocol_id"},
    Table{"question", "questions.csv", "question_id"},
    Table{"run", "runs.csv", "run_id"},
    Table{"session", "sessions.csv", "session_id"},
    Table{"trial", "trials.csv", "trial_id"},
    Table{"presentation", "presentations.csv", "presentation_id"},
    Table{"frame", "frames.csv", "presentation_id, frame_index"},
    Table{"response", "responses.csv", "response_id"},
    Table{"event", "events.csv", "event_id"},
};
constexpr const char* ratings_file = "ratings.csv";
constexpr const char* dictionary_file = "dictionary.csv";
constexpr const char* dictionary_header = "file,column,type,meaning\r\n";

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string csv_value(const Statement& row, int column) {
  if (row.is_null(column)) return {};
  if (!row.is_real(column)) return csv_field(row.text(column));
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), row.real(column)).ptr};
}

bool is_our_name(const std::string& name) {
  if (name == ratings_file || name == dictionary_file) return true;
  if (name.starts_with("protocol_") && name.ends_with(".toml")) return true;
  for (const Table& table : tables) {
    if (name == table.file) return true;
  }
  return false;
}

/// True for an earlier export of ours: only our names, and a dictionary that begins like ours.
bool is_export(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file() || !is_our_name(entry.path().filename().string())) return false;
  }
  std::ifstream dictionary(folder / dictionary_file, std::ios::binary);
  std::string begin(std::strlen(dictionary_header), '\0');
  dictionary.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin == dictionary_header;
}

void check_target(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::exists(fs::symlink_status(folder, ignored))) return;
  const bool ours = !fs::is_symlink(folder) && fs::is_directory(folder, ignored) &&
                    (fs::is_empty(folder, ignored) || is_export(folder));
  if (!ours) {
    throw base::Error(folder.string(), "exists and is not an earlier export",
                      "name another folder, or move what is there away");
  }
}

/// A folder beside the target that is gone unless put in place.
class Draft {
 public:
  explicit Draft(const fs::path& target) : target_(target) {
    path_ = target_.string() + ".tmp" + std::to_string(::getpid());
    if (::mkdir(path_.c_str(), 0777) != 0) fail("cannot be made");
  }
  ~Draft() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  const fs::path& path() const { return path_; }

  /// After the exchange the earlier export lies under the draft's name and goes with it.
  void put_in_place() {
    std::error_code ignored;
    const unsigned flags = fs::exists(target_, ignored) ? RENAME_EXCHANGE : RENAME_NOREPLACE;
    if (::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, target_.c_str(), flags) == 0) return;
    // Network file systems know the plain rename alone: the earlier export steps aside first.
    if (errno != EINVAL || !replace_in_two_steps()) fail("cannot be put in place");
  }

 private:
  bool replace_in_two_steps() {
    std::error_code ignored;
    const fs::path aside = path_.string() + ".old";
    if (fs::exists(target_, ignored) && ::rename(target_.c_str(), aside.c_str()) != 0) return false;
    if (::rename(path_.c_str(), target_.c_str()) != 0) {
      const int problem = errno;
      ::rename(aside.c_str(), target_.c_str());
      errno = problem;
      return false;
    }
    fs::remove_all(aside, ignored);
    return true;
  }

  [[noreturn]] void fail(const std::string& problem) {
    throw base::Error(target_.string(), problem + ": " + std::strerror(errno),
                      "free space, or name a folder where you may write");
  }

  fs::path target_, path_;
};

/// A file that is an error unless every byte of it came to the disk.
class CsvFile {
 public:
  CsvFile(const fs::path& path, const std::string& shown)
      : shown_(shown), file_(std::fopen(path.c_str(), "wb")) {
    if (!file_) fail();
  }
  ~CsvFile() {
    if (file_) std::fclose(file_);
  }
  CsvFile(const CsvFile&) = delete;
  CsvFile& operator=(const CsvFile&) = delete;

  void write(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail();
  }
  void finish() {
    if (std::fflush(file_) != 0 || ::fsync(::fileno(file_)) != 0) fail();
  }

 private:
  [[noreturn]] void fail() const {
    throw base::Error(shown_, std::string("cannot be written: ") + std::strerror(errno),
                      "free space, or name a folder where you may write");
  }

  std::string shown_;
  std::FILE* file_;
};

/// The rows that `sql` selects, under a line with the names of its columns.
std::int64_t write_rows(Connection& database, const std::string& sql, const char* name,
                        const fs::path& folder, const fs::path& target) {
  CsvFile file(folder / name, (target / name).string());
  Statement row(database, sql);
  std::string line;
  for (int i = 0; i < row.columns(); ++i) line += (i ? "," : "") + row.column_name(i);
  file.write(line + "\r\n");
  std::int64_t rows = 0;
  for (; row.step(); ++rows) {
    line.clear();
    for (int i = 0; i < row.columns(); ++i) {
      if (i) line += ',';
      line += csv_value(row, i);
    }
    file.write(line += "\r\n");
  }
  file.finish();
  return rows;
}

std::int64_t write_dictionary(Connection& database, const fs::path& folder, const fs::path& target) {
  CsvFile file(folder / dictionary_file, (target / dictionary_file).string());
  file.write(dictionary_header);
  std::int64_t rows = 0;
  std::map<std::pair<std::string, std::string>, ColumnMeaning> schema;
  const auto write = [&](const char* name, const std::string& column, const ColumnMeaning& meaning) {
    file.write(std::string(name) + ',' + csv_field(column) + ',' + meaning.type + ',' +
               csv_field(meaning.meaning) + "\r\n");
    ++rows;
  };
  for (const Table& table : tables) {
    Statement sql(database, "SELECT sql FROM sqlite_schema WHERE type = 'table' AND name = ?");
    if (!sql.bind(0, table.name).step()) continue;
    for (const ColumnMeaning& column : column_meanings(table.name, sql.text(0))) {
      write(table.file, column.column, column);
      schema[{column.table, column.column}] = column;
    }
  }
  for (const RatingColumn& column : rating_columns()) {
    write(ratings_file, column.name, schema[{column.table, column.column}]);
  }
  file.finish();
  return rows;
}

void write_protocols(Connection& database, const fs::path& folder, const fs::path& target) {
  for (Statement row(database, "SELECT sha256, text FROM protocol"); row.step();) {
    const std::string name = "protocol_" + row.text(0).substr(0, 12) + ".toml";
    CsvFile file(folder / name, (target / name).string());
    file.write(row.text(1));
    file.finish();
  }
}

}  // namespace

std::vector<ColumnMeaning> column_meanings(const std::string& table, const std::string& create_sql) {
  static const std::set<std::string> types{"INTEGER", "REAL", "TEXT", "BLOB"};
  std::vector<ColumnMeaning> columns;
  std::istringstream lines(create_sql);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, type;
    words >> name >> type;
    if (!type.empty() && type.back() == ',') type.pop_back();
    const std::size_t comment = line.find("-- ");
    const std::string meaning = comment == std::string::npos ? "" : line.substr(comment + 3);
    if (types.count(type)) {
      columns.push_back({table, name, type, meaning});
    } else if (!columns.empty() && columns.back().meaning.empty()) {
      // A column that runs over two lines has its comment on the second.
      columns.back().meaning = meaning;
    }
  }
  return columns;
}

std::vector<ExportedFile> export_csv(const fs::path& path, const fs::path& folder) {
  fs::path target = fs::absolute(folder).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();
  check_target(target);
  const auto database = open_database(path, sqlite::Open::Read, read_schema_steps());
  Draft draft(target);
  std::vector<ExportedFile> files;
  // One transaction: all tables from the same moment, though a session may be running.
  database->execute("BEGIN");
  for (const Table& table : tables) {
    const std::string sql = std::string("SELECT * FROM ") + table.name + " ORDER BY " + table.order;
    files.push_back({table.file, write_rows(*database, sql, table.file, draft.path(), target)});
  }
  files.push_back(
      {ratings_file, write_rows(*database, rating_table_sql(), ratings_file, draft.path(), target)});
  files.push_back({dictionary_file, write_dictionary(*database, draft.path(), target)});
  write_protocols(*database, draft.path(), target);
  database->execute("COMMIT");
  draft.put_in_place();
  return files;
}

}  // namespace study
