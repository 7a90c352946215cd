#include "libstudy/store/withdraw.hpp"

#include <optional>

#include "libstudy/store/answer_journal.hpp"
#include "libstudy/store/file/backups.hpp"
#include "libstudy/store/file/beside.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/file/writer_lock.hpp"
#include "libstudy/store/open_study.hpp"
#include "libstudy/store/refusals.hpp"
#include "libstudy/store/settling.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Statement;

namespace {

/// The person with this participant code, even if the person withdrew; none if the code was never used.
std::optional<std::string> known_person(Connection& database, const std::string& participant) {
  Statement row(database,
                "SELECT person FROM session WHERE participant = ?1 UNION "
                "SELECT person FROM tombstone WHERE participant = ?1");
  if (!row.bind_all(participant).step()) return {};
  return row.text(0);
}

std::int64_t count(Connection& database, const char* sql, const std::string& person) {
  Statement row(database, sql);
  return row.bind_all(person).step() ? row.integer(0) : 0;
}

}  // namespace

Stock take_stock(Connection& database, const std::string& person) {
  Stock stock;
  stock.sessions = count(database, "SELECT count(*) FROM session WHERE person = ?", person);
  stock.answers =
      count(database,
            "SELECT count(*) FROM response JOIN unit USING (unit_id) JOIN session USING (session_id) "
            "WHERE person = ?",
            person);
  stock.frames = count(database,
                       "SELECT count(*) FROM frame JOIN presentation USING (presentation_id) "
                       "JOIN trial USING (trial_id) JOIN session USING (session_id) WHERE person = ?",
                       person);
  Statement row(
      database,
      "SELECT DISTINCT station FROM session WHERE person = ? AND station <> '' AND imported_from IS "
      "NULL ORDER BY 1");
  for (row.bind_all(person); row.step();) stock.stations.push_back(row.text(0));
  Statement source(database,
                   "SELECT DISTINCT imported_from || ', SHA-256 ' || source_sha256 FROM session "
                   "WHERE person = ? AND imported_from IS NOT NULL ORDER BY 1");
  for (source.bind_all(person); source.step();) stock.sources.push_back(source.text(0));
  return stock;
}

std::vector<std::string> requested_withdrawals(Connection& database) {
  Statement row(
      database,
      "SELECT DISTINCT s.participant FROM session s JOIN event e USING (session_id) WHERE e.kind = ? "
      "ORDER BY 1");
  std::vector<std::string> participants;
  for (row.bind_all(std::string(withdrawal_request)); row.step();) participants.push_back(row.text(0));
  return participants;
}

std::vector<std::string> requested_withdrawals(const StudyFile& study) {
  return requested_withdrawals(*open_study(study).database);
}

Withdrawal withdraw(Connection& database, const std::string& participant) {
  database.execute("PRAGMA temp_store = MEMORY");
  const auto person = known_person(database, participant);
  if (!person) {
    { const AnswerJournal compared(database); }
    clean_up(database);  // does the chores that other people's withdrawals left over
    throw base::Error(database.path().string(), "knows no participant " + participant,
                      "vip-study status lists the codes");
  }
  Withdrawal done;
  done.deleted = take_stock(database, *person);
  prepare_rewrite(database, {*person});
  sqlite::Transaction transaction(database);
  bury(database, *person, static_cast<std::int64_t>(read_schema_steps().size()));
  ChorePlan plan(database);
  plan.forget(*person, participant);
  plan.rewrite();
  transaction.commit();
  done.beside = clean_up_all(database);
  return done;
}

Withdrawal withdraw(const fs::path& given, const std::string& participant) {
  const fs::path path = real_file(given);
  const WriterLock lock(path);
  const auto database = open_database(path, sqlite::Open::Write, read_schema_steps());
  JournalFile journal(journal_beside(path));
  const std::set<std::string> gaze_deleted = settle(*database, journal).gaze_deleted;
  Withdrawal done = withdraw(*database, participant);
  const auto named = name_gaze_elsewhere(*database, gaze_deleted);  // omits the person who withdrew just now
  done.beside.left.insert(done.beside.left.end(), named.begin(), named.end());
  return done;
}

}  // namespace study
