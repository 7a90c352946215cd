#include "libstudy/store/remote/central_study.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <set>

#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/central/central_schema.hpp"
#include "libstudy/store/central/postgres.hpp"
#include "libstudy/store/export_labels.hpp"
#include "libstudy/store/export_register.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/file/schema.hpp"
#include "libstudy/store/merge/merge_parts.hpp"
#include "libstudy/store/open_study.hpp"
#include "stats/base/error.hpp"

namespace study {

using central::Scope;
using sqlite::Connection;
using sqlite::Statement;

namespace {

// A station's row numbers are unique within a session only, so each session gets a range of its own. The
// merge numbers all rows anew.
constexpr std::int64_t numbers_of_a_session = std::int64_t{1} << 40;

/// A column that a row of SQLite gets from a row of the centre.
struct FilledColumn {
  enum class From {
    Text,    ///< the text itself
    Whole,   ///< a whole number
    Real,    ///< a real number
    Bytes,   ///< bytes in hexadecimal digits
    Number,  ///< a row number within a session
    Name     ///< a name that stands for a row number
  };
  std::string name;  ///< in SQLite
  From from = From::Text;
  std::size_t place = 0;        ///< of the value in the row of the centre
  std::string names;            ///< of a name: "session_id", "run_id", "protocol_id" or "question_id"
  std::size_t protocol_at = 0;  ///< of a question's name: place of its protocol's hash
};

/// Columns with row numbers that are unique within a session.
std::set<std::string> numbered_columns() {
  std::set<std::string> found;
  for (const central::Table& table : central::tables())
    if (table.scope == Scope::Session && table.key.size() == 2) found.insert(table.key.back());
  return found;
}

std::size_t place_of(const central::Table& table, const std::string& column) {
  const auto found = std::find_if(table.columns.begin(), table.columns.end(),
                                  [&](const central::Column& one) { return one.name == column; });
  if (found == table.columns.end())
    throw std::logic_error("table " + table.name + " lacks " + column + " at the centre");
  return static_cast<std::size_t>(found - table.columns.begin());
}

/// For each column of SQLite how it is filled.
std::vector<FilledColumn> filled_columns(const central::Table& table, const std::set<std::string>& numbered) {
  using From = FilledColumn::From;
  static const std::map<std::string, std::string> names{{"session_id", "session_uid"},
                                                        {"run_id", "run_uid"},
                                                        {"protocol_id", "protocol_sha256"},
                                                        {"question_id", "question_code"}};
  static const std::map<std::string, std::map<std::string, std::string>> own{
      {"session", {{"uid", "session_uid"}}},
      {"run", {{"uid", "run_uid"}}},
      {"protocol", {{"sha256", "protocol_sha256"}}},
      {"question", {{"code", "question_code"}}}};
  std::vector<FilledColumn> out;
  for (const std::string& column : columns_of(table.name)) {
    FilledColumn filled{column, From::Text, 0, {}, 0};
    std::string source = column;
    if (const auto name = names.find(column); name != names.end()) {
      source = name->second;
      filled.from = From::Name;
      filled.names = column;
      if (column == "question_id") filled.protocol_at = place_of(table, "protocol_sha256");
    } else if (const auto root = own.find(table.name); root != own.end() && root->second.contains(column)) {
      source = root->second.at(column);
    }
    filled.place = place_of(table, source);
    const std::string& type = table.columns[filled.place].type;
    if (filled.from != From::Name) {
      if (table.scope == Scope::Session && numbered.contains(column))
        filled.from = From::Number;
      else if (type == "bigint")
        filled.from = From::Whole;
      else if (type == "double precision")
        filled.from = From::Real;
      else if (type == "bytea")
        filled.from = From::Bytes;
    }
    out.push_back(std::move(filled));
  }
  return out;
}

[[noreturn]] void refuse_value(const std::string& shown, const std::string& table, const std::string& value) {
  throw base::Error(shown, "table " + table + " holds '" + printable(value) + "', which is no value of it",
                    "ask the owner of the central database to look at it");
}

template <class Value>
Value number_of_text(const std::string& text, const std::string& shown, const std::string& table) {
  Value value{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem == std::errc() && end == text.data() + text.size()) return value;
  if constexpr (std::is_floating_point_v<Value>) {
    if (text == "Infinity") return std::numeric_limits<Value>::infinity();
    if (text == "-Infinity") return -std::numeric_limits<Value>::infinity();
  }
  refuse_value(shown, table, text);
}

std::string bytes_of_hex(const std::string& text) {
  std::string bytes;
  for (std::size_t i = 2; i + 1 < text.size(); i += 2)  // after "\x"
    bytes += static_cast<char>(std::stoi(text.substr(i, 2), nullptr, 16));
  return bytes;
}

/// The temporary database of one station, and the row numbers in it by name.
struct StationCopy {
  std::unique_ptr<Connection> database;
  std::map<std::string, std::map<std::string, std::int64_t>> numbers;
  std::map<std::string, std::size_t> questions;  ///< place in its protocol, by hash and code

  /// The row number of a name. A new name gets the next number; questions get theirs by their protocol.
  std::int64_t number(const std::string& names, const std::string& name) {
    auto& known = numbers[names];
    return known.try_emplace(name, static_cast<std::int64_t>(known.size()) + 1).first->second;
  }
};

class CentralReader {
 public:
  explicit CentralReader(const std::string& service)
      : shown_("service:" + service), central_(service), numbered_(numbered_columns()) {}

  std::vector<std::unique_ptr<Connection>> read() {
    pg::Transaction one_state(central_, "BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY");
    choose_schema();
    for (const char* first : {"protocol", "question", "run", "session"}) read_table(first);
    for (const central::Table& table : central::tables())
      if (!read_.contains(table.name)) read_table(table.name);
    one_state.commit();
    std::vector<std::unique_ptr<Connection>> out;
    for (auto& [sender, copy] : copies_) {
      copy.database->execute("COMMIT");
      out.push_back(std::move(copy.database));
    }
    return out;
  }

 private:
  void choose_schema() {
    for (const char* schema : {"lab", "shared"}) {
      const auto rights = central_.run(
          "SELECT coalesce(has_schema_privilege(oid, 'USAGE'), false) FROM pg_catalog.pg_namespace "
          "WHERE nspname = $1",
          {schema});
      if (rights.size() == 1 && rights.text(0, 0) == "t") {
        schema_ = schema;
        return check_schema_number();
      }
    }
    throw base::Error(shown_, "its role may read neither the schema lab nor the schema shared",
                      "let the owner of the central database make it a reader: vip-study central add-reader");
  }

  void check_schema_number() {
    const auto found = central_.run("SELECT number FROM " + schema_ + ".schema_version");
    const std::int64_t there = found.size() > 0 ? found.integer(0, 0) : 0, here = central::schema_number();
    if (there == here) return;
    throw base::Error(
        shown_,
        "has schema " + std::to_string(there) + ", and this program reads schema " + std::to_string(here),
        there < here ? "let its owner run vip-study central upgrade"
                     : "use the newer program on this computer");
  }

  StationCopy& copy_of(const std::string& sender) {
    StationCopy& copy = copies_[sender];
    if (!copy.database) {
      copy.database = make_temporary_database(shown_ + " (" + printable(sender) + ")");
      copy.database->execute("PRAGMA foreign_keys = OFF; BEGIN");
    }
    return copy;
  }

  /// Numbers a protocol's questions in their order in the file, as the station did.
  void number_questions(StationCopy& copy, const std::string& sha256, const std::string& text) {
    std::vector<std::string> codes;
    try {
      const Protocol protocol = parse_protocol(text, shown_, ProtocolUse::Stored);
      for (const auto& [block, question] : all_questions(protocol)) codes.push_back(question->id);
    } catch (const base::Error&) {
      // This version cannot read the protocol: its questions are numbered in the order of their codes.
    }
    for (const std::string& code : codes) copy.number("question_id", sha256 + " " + code);
  }

  void read_table(const std::string& name) {
    const central::Table& table = central::table(name);
    read_.insert(name);
    const auto columns = filled_columns(table, numbered_);
    std::string list, places;
    for (const FilledColumn& one : columns) {
      list += (list.empty() ? "\"" : ", \"") + one.name + "\"";
      places += places.empty() ? "?" : ", ?";
    }
    std::map<std::string, Statement> inserts;
    std::string order;
    for (const std::string& key : table.key) order += (order.empty() ? "" : ", ") + pg::quoted_name(key);
    central_.copy_out(
        "COPY (SELECT sender, " + central::column_list(table) + " FROM " + schema_ + "." +
            pg::quoted_name(name) + (table.large ? "" : " ORDER BY sender, " + order) + ") TO STDOUT",
        [&](const pg::Row& row) {
          StationCopy& copy = copy_of(row.front().value());
          auto insert = inserts.find(*row.front());
          if (insert == inserts.end())
            insert = inserts
                         .try_emplace(*row.front(), *copy.database,
                                      "INSERT INTO \"" + name + "\" (" + list + ") VALUES (" + places + ")")
                         .first;
          fill(insert->second, columns, table, row, copy);
          insert->second.run();
          if (name == "protocol")
            number_questions(copy, row[1 + place_of(table, "protocol_sha256")].value(),
                             row[1 + place_of(table, "text")].value());
        });
  }

  void fill(Statement& insert, const std::vector<FilledColumn>& columns, const central::Table& table,
            const pg::Row& row, StationCopy& copy) {
    using From = FilledColumn::From;
    int index = 0;
    for (const FilledColumn& column : columns) {
      const pg::Field& field = row[1 + column.place];
      if (!field) {
        insert.bind_at(index++, std::nullopt);
        continue;
      }
      switch (column.from) {
        case From::Text:
          insert.bind_at(index, *field);
          break;
        case From::Whole:
          insert.bind_at(index, number_of_text<std::int64_t>(*field, shown_, table.name));
          break;
        case From::Real:
          insert.bind_at(index, number_of_text<double>(*field, shown_, table.name));
          break;
        case From::Bytes: {
          const std::string bytes = bytes_of_hex(*field);
          insert.bind_at(index, sqlite::Blob{bytes});
          break;
        }
        case From::Number: {
          const auto number = number_of_text<std::int64_t>(*field, shown_, table.name);
          if (number < 0 || number >= numbers_of_a_session) refuse_value(shown_, table.name, *field);
          const auto session = copy.number("session_id", row[1].value());
          insert.bind_at(index, session * numbers_of_a_session + number);
          break;
        }
        case From::Name: {
          const std::string name =
              column.names == "question_id" ? row[1 + column.protocol_at].value() + " " + *field : *field;
          insert.bind_at(index, copy.number(column.names, name));
          break;
        }
      }
      ++index;
    }
  }

  std::string shown_, schema_;
  pg::Connection central_;
  std::set<std::string> numbered_, read_;
  std::map<std::string, StationCopy> copies_;
};

}  // namespace

std::unique_ptr<Connection> read_central_study(const std::string& service) {
  merging::Content content;
  for (auto& copy : CentralReader(service).read()) merging::add_source(content, std::move(copy));
  const auto chosen = merging::choose_sessions(content);
  const auto names = merging::name_people(content);
  auto study = make_temporary_database("service:" + service);
  merging::write_union(content, chosen, names, *study);
  give_labels(*study);
  return study;
}

void read_central_studies(std::function<void(const std::string& line)> tell) {
  read_central_with([tell = std::move(tell)](const std::string& service) {
    auto study = read_central_study(service);
    CleanUp done;
    try {
      delete_exports_of_service(*study, done);
    } catch (const base::Error& error) {
      done.left.emplace_back(error.what());
    }
    for (const auto& path : done.cleaned)
      tell("deleted " + path.string() + ": a person in it withdrew; export again");
    for (const std::string& line : done.left) tell(line);
    return study;
  });
}

}  // namespace study
