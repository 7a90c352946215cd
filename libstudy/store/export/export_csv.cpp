#include "libstudy/store/export/export_csv.hpp"

#include <array>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "libstudy/store/export/presentmon.hpp"
#include "libstudy/store/export/sickness_table.hpp"
#include "libstudy/store/read/run_settings.hpp"
#include "libstudy/store/refusals.hpp"
#include "stats/base/pattern.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Statement;

namespace {

struct CsvTable {
  const char* name;         // name in the schema
  const char* file;         // file name in the export
  const char* order;        // columns to sort by, so that equal databases give equal files
  const char* left = "";    // a column that the export omits; empty: none
  bool free_words = false;  // true: free text, written only if CsvChoice::words
  bool gaze = false;        // true: gaze data; with CsvChoice::gaze, written for sessions that allow gaze
};

constexpr std::array tables{
    CsvTable{"protocol", "protocols.csv", "protocol_id"},
    CsvTable{"question", "questions.csv", "question_id"},
    CsvTable{"ask", "asks.csv", "protocol_id, block, place"},
    CsvTable{"cell", "cells.csv", "protocol_id, cell"},
    CsvTable{"run", "runs.csv", "run_id"},
    CsvTable{"session", "sessions.csv", "session_id"},
    CsvTable{"framing", "framings.csv", "framing_id"},
    CsvTable{"headset", "headsets.csv", "headset_id"},
    CsvTable{"ipd", "ipds.csv", "ipd_id"},
    CsvTable{"unit", "units.csv", "unit_id"},
    CsvTable{"trial", "trials.csv", "trial_id"},
    CsvTable{"presentation", "presentations.csv", "presentation_id"},
    CsvTable{"frame", "frames.csv", "presentation_id, frame_index"},
    CsvTable{"slot", "slots.csv", "presentation_id, slot_index"},
    CsvTable{"head", "heads.csv", "presentation_id, slot_index", "", false, true},
    CsvTable{"gaze", "gaze.csv", "presentation_id, sample_index", "", false, true},
    CsvTable{"gaze_validation", "gaze_validations.csv", "session_id, validation, point", "", false, true},
    CsvTable{"marker", "markers.csv", "marker_id"},
    CsvTable{"tracker_clock", "tracker_clocks.csv", "tracker_clock_id"},
    CsvTable{"light", "light.csv", "presentation_id"},
    CsvTable{"response", "responses.csv", "response_id", "words"},
    CsvTable{"response", "words.csv", "response_id", "", true},
    CsvTable{"note", "notes.csv", "note_id", "", true},
    CsvTable{"permission_change", "permission_changes.csv", "permission_change_id"},
    CsvTable{"tombstone", "tombstones.csv", "participant"},
    CsvTable{"event", "events.csv", "event_id"},
};

/// A column that the export adds to the columns of a table. table: name in the schema; expression: SQL for
/// the value.
struct AddedColumn {
  const char *table, *name, *type, *expression, *meaning;
};
constexpr std::array added_columns{
    AddedColumn{"session", "setting_sha256", "TEXT", setting_sha256_sql, setting_sha256_meaning},
    AddedColumn{"session", "sharing_allowed", "INTEGER",
                "(SELECT granted FROM sharing h WHERE h.person = session.person)",
                "1: the participant may stand in public exports (BIDS, Psych-DS); 0: refused in some "
                "session, or asked and not answered; empty: never asked"},
    AddedColumn{
        "session", "gaze_allowed", "INTEGER",
        "(SELECT granted FROM permission p WHERE p.session_id = session.session_id AND p.what = 'gaze')",
        "1: gaze may be recorded in this session; 0: refused, or asked and not answered; empty: not asked"},
    AddedColumn{"presentation", "counts", "INTEGER",
                "(SELECT counts FROM showing w WHERE w.presentation_id = presentation.presentation_id)",
                showing_counts_meaning},
    AddedColumn{"presentation", "why_not", "TEXT",
                "(SELECT why_not FROM showing w WHERE w.presentation_id = presentation.presentation_id)",
                showing_why_not_meaning},
    AddedColumn{"response", "counts", "INTEGER",
                "(SELECT counts FROM answer a WHERE a.response_id = response.response_id)",
                "1: the answer counts, 0: why_not says why"},
    AddedColumn{
        "response", "why_not", "TEXT",
        "(SELECT why_not FROM answer a WHERE a.response_id = response.response_id)",
        "set aside (with the showing that it judged), answered again, excluded (by the experimenter), "
        "not answered or practice; empty: the answer counts"}};
bool is_of(const AddedColumn& column, const CsvTable& table) {
  return std::strcmp(table.name, column.table) == 0;
}

constexpr const char* ratings_file = "ratings.csv";
constexpr const char* dictionary_file = "dictionary.csv";
constexpr const char* dictionary_header = "file,column,type,meaning\r\n";

bool is_csv_name(const std::string& name) {
  if (name == ratings_file || name == dictionary_file || is_presentmon_name(name)) return true;
  const bool toml = name.ends_with(".toml");
  if (toml && (name.starts_with("protocol_") || name.starts_with("setting_"))) return true;
  for (const SicknessTable& table : sickness_tables({})) {
    if (name == table.name + ".csv") return true;
  }
  for (const CsvTable& table : tables) {
    if (name == table.file) return true;
  }
  return false;
}

/// True if the folder has a dictionary.csv that begins with the header line of vip-study's data dictionary.
bool is_csv_export(const fs::path& folder) {
  std::ifstream dictionary(folder / dictionary_file, std::ios::binary);
  std::string begin(std::strlen(dictionary_header), '\0');
  dictionary.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin == dictionary_header;
}

constexpr ExportKind csv_kind{"csv", is_csv_export, is_csv_name};

/// The columns of a table with their meanings (column_meanings()), parsed once per table: meaning_of() needs
/// them again for each column.
const std::vector<ColumnMeaning>& known_meanings(const std::string& table, const std::string& create_sql) {
  thread_local std::map<std::pair<std::string, std::string>, std::vector<ColumnMeaning>> known;
  const auto [found, fresh] = known.try_emplace({table, create_sql});
  if (fresh) found->second = column_meanings(table, create_sql);
  return found->second;
}

std::vector<ColumnMeaning> columns_of(Connection& database, const CsvTable& table) {
  Statement sql(database, "SELECT sql FROM sqlite_schema WHERE type = 'table' AND name = ?");
  if (!sql.bind_all(table.name).step()) return {};
  auto columns = known_meanings(table.name, sql.text(0));
  std::erase_if(columns, [&](const ColumnMeaning& column) { return column.column == table.left; });
  return columns;
}

std::string select_sql(Connection& database, const CsvTable& table) {
  std::string list;
  for (const ColumnMeaning& column : columns_of(database, table))
    list += (list.empty() ? "" : ", ") + column.column;
  for (const AddedColumn& column : added_columns) {
    if (is_of(column, table)) list += std::string(", ") + column.expression + " AS " + column.name;
  }
  const std::string condition = table.gaze ? " WHERE " + gaze_allowed_sql(table.name) : "";
  return "SELECT " + list + " FROM " + table.name + condition + " ORDER BY " + table.order;
}

bool is_written(const CsvTable& table, const CsvChoice& choice) {
  return (!table.free_words || choice.words) && (!table.gaze || choice.gaze);
}

std::string spreadsheet_meaning(const CsvDialect& dialect) {
  return std::string("written for spreadsheets (--excel): UTF-8 behind a byte-order mark, '") +
         dialect.separator + "' between fields, '" + dialect.decimal +
         "' as the decimal mark. R reads it by " +
         (dialect.separator == ';' ? "read.csv2(file, fileEncoding = \"UTF-8-BOM\"), pandas by "
                                     "read_csv(file, sep=\";\", decimal=\",\", encoding=\"utf-8-sig\")"
                                   : "read.csv(file, fileEncoding = \"UTF-8-BOM\"), pandas by "
                                     "read_csv(file, encoding=\"utf-8-sig\")") +
         ". A spreadsheet keeps 15 digits of a number: seeds and times in ns may lose their last ones there";
}

std::int64_t write_dictionary(Connection& database, const ExportDraft& draft, const CsvChoice& choice) {
  ExportFile file(draft, dictionary_file);
  const CsvDialect& dialect = draft.dialect();
  file.write(csv_head({"file", "column", "type", "meaning"}, dialect));
  std::int64_t rows = 0;
  const auto write = [&](const char* name, const ColumnMeaning& column) {
    file.write(csv_line(
        {name, csv_field(column.column, dialect), column.type, csv_field(column.meaning, dialect)}, dialect));
    ++rows;
  };
  write("(all)", {"", "(all)", "TEXT", formula_guard_meaning});
  if (dialect.mark) write("(all)", {"", "(all)", "TEXT", spreadsheet_meaning(dialect)});
  for (const CsvTable& table : tables) {
    if (!is_written(table, choice)) continue;
    for (const ColumnMeaning& column : columns_of(database, table)) write(table.file, column);
    for (const AddedColumn& column : added_columns) {
      if (is_of(column, table)) write(table.file, {table.name, column.name, column.type, column.meaning});
    }
  }
  for (const RatingColumn& column : rating_columns(database))
    write(ratings_file, meaning_of(database, column));
  for (const SicknessTable& table : sickness_tables({})) {
    for (const SicknessColumn& column : table.columns)
      write((table.name + ".csv").c_str(), {"", column.name, column.type, column.meaning});
  }
  if (choice.presentmon)
    for (const ColumnMeaning& column : presentmon_columns()) write("presentmon/*.csv", column);
  file.finish();
  return rows;
}

void write_protocols(Connection& database, const ExportDraft& draft) {
  for (Statement row(database, "SELECT sha256, text FROM protocol"); row.step();) {
    write_file(draft, "protocol_" + row.text(0).substr(0, 12) + ".toml", row.text(1));
  }
}

/// Reformats the SQL of a table to which a schema step added columns. SQLite inserts an added column before
/// the comment of the last column. This function moves each added column to its own line at the end, followed
/// by its comment.
std::string with_added_last(const std::string& create_sql) {
  static const base::Pattern added(R"(, (\w+ \w+) /\* ([^*]*) \*/)");
  std::string last;
  std::string out = added.replaced(create_sql, [&](const base::Groups& found) {
    last += "\n" + found[1] + ", -- " + found[2];
    return "";
  });
  return out + last;
}

}  // namespace

ColumnMeaning meaning_of(Connection& database, const RatingColumn& column) {
  for (const ColumnMeaning& found : columns_of(database, {column.table.c_str(), "", ""})) {
    if (found.column != column.column) continue;
    const std::string& meaning = column.meaning.empty() ? found.meaning : column.meaning;
    return {column.table, column.name, column.expression.empty() ? found.type : column.type,
            rating_subject(column) + meaning};
  }
  return {column.table, column.name, "", ""};
}

std::vector<ColumnMeaning> column_meanings(const std::string& table, const std::string& create_sql) {
  static const std::set<std::string> types{"INTEGER", "REAL", "TEXT", "BLOB"};
  std::vector<ColumnMeaning> columns;
  std::istringstream lines(with_added_last(create_sql));
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
      // The definition of a column may take two lines; its comment is then on the second line.
      columns.back().meaning = meaning;
    }
  }
  return columns;
}

std::vector<ExportedFile> export_csv(const StudyFile& study, const fs::path& folder,
                                     const CsvChoice& choice) {
  const auto database = open_to_export(study);
  // Reads all tables in one transaction, so that they are consistent even while a session writes.
  database->execute("BEGIN");
  ExportDraft draft({study.path, csv_kind, everybody(*database), Readers::Owner, choice.dialect}, folder);
  std::vector<ExportedFile> files;
  for (const CsvTable& table : tables) {
    if (!is_written(table, choice)) continue;
    files.push_back({table.file, write_csv(*database, select_sql(*database, table), draft, table.file)});
  }
  files.push_back({ratings_file, write_csv(*database, rating_table_sql(*database), draft, ratings_file)});
  for (const SicknessTable& table : sickness_tables(read_sickness(*database)))
    files.push_back({table.name + ".csv", write_sickness(table, draft, table.name + ".csv")});
  if (choice.presentmon) files.push_back(write_presentmon(*database, draft));
  files.push_back({dictionary_file, write_dictionary(*database, draft, choice)});
  write_protocols(*database, draft);
  for (const RunSetting& setting : run_settings(*database))
    write_file(draft, setting_file_name(setting), setting.text);
  database->execute("COMMIT");
  draft.put_in_place();
  return files;
}

}  // namespace study
