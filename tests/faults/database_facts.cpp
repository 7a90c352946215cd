#include <algorithm>

#include "libstudy/store/file/sqlite.hpp"
#include "tests/faults/invariants.hpp"

namespace faults {

using study::sqlite::Connection;
using study::sqlite::Open;
using study::sqlite::Statement;

namespace {

/// SQL for a person's decision in force: 1 allowed, 0 refused. Among changes of the permission that no later
/// change superseded, a refusal wins, because stations that did not know of each other may have recorded
/// both. Schemas without the column `superseded`: the last change. Without any change: the last answer on the
/// consent page.
std::string decision_sql(Connection& database, const std::string& what, const std::string& question) {
  const bool says_which_holds =
      database.integer(
          "SELECT count(*) FROM pragma_table_info('permission_change') WHERE name = 'superseded'") > 0;
  const std::string changes =
      " FROM permission_change c WHERE c.session_id = s.session_id AND what = '" + what + "'";
  return "coalesce((SELECT " +
         (says_which_holds ? "min(granted)" + changes + " AND coalesce(superseded, 0) = 0"
                           : "granted" + changes + " ORDER BY permission_change_id DESC LIMIT 1") +
         "), (SELECT score FROM response JOIN unit u USING (unit_id) JOIN question q USING (question_id) "
         "WHERE "
         "u.session_id = s.session_id AND q.code = '" +
         question + "' ORDER BY response_id DESC LIMIT 1))";
}

void read_sessions(Connection& database, DatabaseFacts& facts) {
  const std::string of_session =
      " JOIN presentation p USING (presentation_id) JOIN trial t USING (trial_id) WHERE t.session_id = "
      "s.session_id)";
  const std::string changes =
      "(SELECT count(*) FROM permission_change c WHERE c.session_id = s.session_id AND what = '";
  Statement row(database,
                "SELECT person, participant, code, station, state, " +
                    decision_sql(database, "gaze", "gaze_kept") + ", " +
                    decision_sql(database, "sharing", "data_shared") + ", " + changes + "gaze'), " + changes +
                    "sharing'), (SELECT count(*) FROM gaze" + of_session + " + (SELECT count(*) FROM head" +
                    of_session +
                    " + (SELECT count(*) FROM gaze_validation v WHERE v.session_id = s.session_id) FROM "
                    "session s");
  while (row.step()) {
    SessionFacts one;
    one.person = row.text(0);
    one.participant = row.text(1);
    one.code = row.text(2);
    one.station = row.text(3);
    one.state = row.text(4);
    if (!row.is_null(5)) one.gaze = row.integer(5) == 1;
    if (!row.is_null(6)) one.sharing = row.integer(6) == 1;
    one.gaze_changes = static_cast<int>(row.integer(7));
    one.sharing_changes = static_cast<int>(row.integer(8));
    one.gaze_rows = static_cast<int>(row.integer(9));
    facts.sessions[one.key()] = one;
  }
  Statement unit(database,
                 "SELECT code || '@' || station, position FROM unit JOIN session s USING (session_id) WHERE "
                 "unit.state = 'done'");
  while (unit.step()) facts.sessions[unit.text(0)].done.insert(static_cast<int>(unit.integer(1)));
  Statement answer(
      database,
      "SELECT s.code || '@' || s.station, u.position || ' ' || q.code || ' ' "
      "|| coalesce(r.score, '') || ' ' || coalesce(r.words, '') FROM response r JOIN unit u USING "
      "(unit_id) JOIN session s USING (session_id) JOIN question q USING (question_id)");
  while (answer.step()) facts.sessions[answer.text(0)].answers.push_back(answer.text(1));
}

void read_rest(Connection& database, DatabaseFacts& facts) {
  for (Statement row(database, "SELECT code || '@' || station FROM tombstone"); row.step();)
    facts.withdrawn.insert(row.text(0));
  Statement row(
      database,
      "SELECT code || '@' || station, position, response_id || ' ' || coalesce(score, '') || ' ' || "
      "coalesce(words, '') FROM response JOIN unit USING (unit_id) JOIN session USING (session_id)");
  while (row.step()) facts.responses.push_back({row.text(0), static_cast<int>(row.integer(1)), row.text(2)});
}

void copy_database(const fs::path& database, const fs::path& to) {
  std::error_code none;
  for (const char* part : {"", "-wal", "-journal"})
    if (fs::exists(database.string() + part, none))
      fs::copy_file(database.string() + part, to.string() + part);
}

bool has_table(Connection& database, const std::string& name) {
  return database.integer("SELECT count(*) FROM sqlite_schema WHERE name = '" + name + "'") > 0;
}

}  // namespace

DatabaseFacts read_facts(const fs::path& database, const fs::path& peek, Problems& problems) {
  DatabaseFacts facts;
  std::error_code none;
  fs::remove_all(peek);
  fs::create_directories(peek);
  try {
    const fs::path copy = peek / "copy.db", own = peek / "copy.personal";
    copy_database(database, copy);
    if (fs::exists(copy, none) && fs::file_size(copy, none) > 0) {
      Connection file(copy, Open::Write);
      facts.there = has_table(file, "permission_change") && has_table(file, "head");
      if (facts.there) {
        read_sessions(file, facts);
        read_rest(file, facts);
      }
    }
    copy_database(database.string() + ".personal", own);
    if (fs::exists(own, none) && fs::file_size(own, none) > 0) {
      Connection file(own, Open::Write);
      if (has_table(file, "personal"))
        for (Statement row(file, "SELECT answer FROM personal"); row.step();)
          facts.personal.insert(row.text(0));
    }
  } catch (const std::exception& error) {
    problems.push_back("cannot be read: " + std::string(error.what()));
  }
  return facts;
}

std::vector<std::string> describe(const DatabaseFacts& facts) {
  const auto word = [](const std::optional<bool>& decision) {
    return std::string(!decision ? "?" : *decision ? "yes" : "no");
  };
  std::vector<std::string> lines;
  for (const auto& [key, one] : facts.sessions) {
    std::string line = key + " is " + one.participant + " " + one.state + " gaze " + word(one.gaze) +
                       (one.gaze_rows > 0 ? " (kept)" : " (none)") + " sharing " + word(one.sharing) +
                       " done";
    for (const int position : one.done) line += " " + std::to_string(position);
    auto answers = one.answers;
    std::sort(answers.begin(), answers.end());
    for (const std::string& answer : answers) line += " | " + answer;
    lines.push_back(line);
  }
  for (const std::string& key : facts.withdrawn) lines.push_back(key + " withdrew");
  return lines;
}

}  // namespace faults
