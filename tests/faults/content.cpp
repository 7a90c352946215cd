#include "tests/faults/content.hpp"

#include <algorithm>
#include <iterator>
#include <sstream>

#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/personal.hpp"
#include "stats/base/file.hpp"

namespace faults {

using study::sqlite::Connection;
using study::sqlite::Open;
using study::sqlite::Statement;

namespace {

Lines select(Connection& database, const std::string& sql) {
  Statement row(database, sql);
  Lines lines;
  while (row.step()) {
    std::string line;
    for (int i = 0; i < row.columns(); ++i) line += (i ? "|" : "") + (row.is_null(i) ? "~" : row.text(i));
    lines.push_back(line);
  }
  return lines;
}

Lines select(const fs::path& path, const std::string& sql) {
  std::error_code ignored;
  if (!fs::exists(path, ignored) || fs::file_size(path, ignored) == 0) return {};
  Connection database(path, Open::Read);
  return select(database, sql);
}

bool is_time(const std::string& column) { return column == "utc" || column.ends_with("_utc"); }

/// Drops lines with a time or the folder's path, which differ between runs.
std::string without_moments(const std::string& text) {
  std::istringstream in(text);
  std::string out;
  for (std::string line; std::getline(in, line);) {
    const bool moment = line.find("utc") != std::string::npos || line.find("Date") != std::string::npos ||
                        line.find(",export,") != std::string::npos;
    if (!moment) out += line + '\n';
  }
  return out;
}

}  // namespace

Lines session_content(const fs::path& database) {
  return select(database,
                "SELECT 'session', participant, visit, seed, slot, state, test_data, station, observer FROM "
                "session ORDER BY participant, visit") +
         select(database,
                "SELECT 'unit', participant, visit, position, block, u.kind, u.state FROM unit u "
                "JOIN session USING (session_id) ORDER BY participant, visit, position") +
         select(
             database,
             "SELECT 'answer', participant, visit, position, question.code, r.score, r.words, count(*) OVER "
             "(PARTITION BY unit_id, question_id) FROM response r JOIN unit USING (unit_id) "
             "JOIN session USING (session_id) JOIN question USING (question_id) "
             "ORDER BY participant, visit, position, question.code") +
         // Of each trial only the last attempt counts, which is the complete one.
         select(database,
                "SELECT 'shown', participant, visit, t.position, p.interval, p.state, p.verdict, p.frames, "
                "p.mean_fps, p.sd_fps, (SELECT count(*) FROM frame f WHERE f.presentation_id = "
                "p.presentation_id) FROM presentation p JOIN trial t USING (trial_id) JOIN session USING "
                "(session_id) WHERE p.attempt = (SELECT max(q.attempt) FROM presentation q WHERE q.trial_id "
                "= p.trial_id) ORDER BY participant, visit, t.position, p.interval");
}

Lines database_content(const fs::path& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored) || fs::file_size(path, ignored) == 0) return {};
  Connection database(path, Open::Read);
  Lines all;
  for (const std::string& table :
       select(database,
              "SELECT name FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'export%' AND "
              "name NOT LIKE 'sqlite%' ORDER BY 1")) {
    std::string columns, order;
    for (const std::string& column :
         select(database, "SELECT name FROM pragma_table_info('" + table + "')")) {
      if (is_time(column) || column == "event_id") continue;
      columns += (columns.empty() ? "" : ", ") + column;
    }
    const std::string which = table == "event" ? " WHERE session_id IS NOT NULL AND kind <> 'resumed'" : "";
    for (const std::string& line : select(database, "SELECT " + columns + " FROM " + table + which))
      all.push_back(table + "|" + line);
  }
  std::sort(all.begin(), all.end());
  return all;
}

Lines permission_content(const fs::path& database) {
  return select(database,
                "SELECT 'permission', participant, visit, what, granted FROM permission JOIN session USING "
                "(session_id) ORDER BY 1, 2, 3, 4");
}

Lines personal_content(const fs::path& database) {
  const fs::path path = study::PersonalFile::beside(database);
  if (select(path, "SELECT 1 FROM sqlite_schema WHERE name = 'personal'").empty()) return {};
  return select(path,
                "SELECT 'personal', participant, question, wording, answer FROM personal ORDER BY 1, 2, 3");
}

Lines folder_content(const fs::path& folder) {
  Lines all;
  std::error_code ignored;
  if (!fs::exists(folder, ignored)) return {"no folder " + folder.filename().string()};
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.path().filename() == "export.sha256") continue;
    const std::string text = without_moments(base::read_file(entry.path(), 1u << 30));
    all.push_back(fs::relative(entry.path(), folder).string() + " " + base::sha256_hex(text));
  }
  std::sort(all.begin(), all.end());
  return all;
}

Lines answer_rows(const fs::path& database) {
  if (!is_planned(database)) return {};
  return select(database,
                "SELECT participant, position, question.code, response_id, r.attempt, r.score, r.words, "
                "r.response_time_s, r.answered_utc FROM response r JOIN unit USING (unit_id) JOIN session "
                "USING (session_id) JOIN question USING (question_id)");
}

Lines done_units(const fs::path& database) {
  if (!is_planned(database)) return {};
  return select(database,
                "SELECT participant || ' ' || position FROM unit u JOIN session USING (session_id) "
                "WHERE u.state = 'done'");
}

bool is_planned(const fs::path& database) {
  if (select(database, "SELECT 1 FROM sqlite_schema WHERE name = 'unit'").empty()) return false;
  return !select(database, "SELECT 1 FROM unit LIMIT 1").empty();
}

bool stands_in(const fs::path& folder, const std::string& needle, std::string& where) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    if (base::read_file(entry.path(), 1u << 30).find(needle) == std::string::npos) continue;
    where = fs::relative(entry.path(), folder).string();
    return true;
  }
  return false;
}

Lines operator+(Lines all, const Lines& more) {
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::string missing(const Lines& part, const Lines& all) {
  Lines left = part, right = all, lacking;
  std::sort(left.begin(), left.end());
  std::sort(right.begin(), right.end());
  std::set_difference(left.begin(), left.end(), right.begin(), right.end(), std::back_inserter(lacking));
  std::string text;
  for (std::size_t i = 0; i < lacking.size() && i < 3; ++i) text += " '" + lacking[i].substr(0, 200) + "'";
  if (lacking.size() > 3) text += " and " + std::to_string(lacking.size() - 3) + " more";
  return text;
}

std::string difference(const Lines& wanted, const Lines& found) {
  const std::string lost = missing(wanted, found), added = missing(found, wanted);
  return (lost.empty() ? "" : " lost" + lost) + (added.empty() ? "" : " added" + added);
}

}  // namespace faults
