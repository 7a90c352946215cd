#include "libstudy/store/read/session_counts.hpp"

#include "libstudy/store/open_study.hpp"

namespace study {

namespace {

constexpr const char* counts_sql =
    "WITH mine AS (SELECT p.*, w.counts FROM presentation p JOIN trial t USING (trial_id) "
    "JOIN showing w USING (presentation_id) WHERE t.session_id = ?1) "
    "SELECT s.participant, s.state, "
    "(SELECT count(*) FROM unit WHERE session_id = ?1), "
    "(SELECT count(*) FROM unit WHERE session_id = ?1 AND state = 'done'), "
    "(SELECT count(*) FROM trial WHERE session_id = ?1), "
    "(SELECT count(*) FROM trial WHERE session_id = ?1 AND state = 'answered'), "
    "(SELECT count(excluded) FROM trial WHERE session_id = ?1), "
    "(SELECT count(*) FROM mine), (SELECT count(*) FROM mine WHERE state = 'interrupted'), "
    "(SELECT count(*) FROM mine WHERE counts), "
    "(SELECT count(*) FROM mine WHERE verdict = 'pass'), "
    "(SELECT count(*) FROM mine WHERE verdict = 'degraded'), "
    "(SELECT count(*) FROM mine WHERE verdict = 'fail'), "
    "(SELECT count(*) FROM response JOIN unit USING (unit_id) WHERE session_id = ?1), "
    "(SELECT count(*) FROM frame WHERE presentation_id IN (SELECT presentation_id FROM mine)), "
    "(SELECT count(*) FROM note WHERE session_id = ?1) "
    "FROM session s WHERE s.session_id = ?1";

std::string number(std::int64_t count) { return std::to_string(count); }

}  // namespace

SessionCounts count_session(const std::filesystem::path& path, std::int64_t session) {
  const auto database = open_study(path).database;
  sqlite::Statement row(*database, counts_sql);
  SessionCounts counts;
  if (!row.bind_all(session).step()) return counts;
  counts.participant = row.text(0);
  counts.state = row.text(1);
  int column = 2;
  for (std::int64_t* count : {&counts.units, &counts.done, &counts.trials, &counts.answered, &counts.excluded,
                              &counts.showings, &counts.cut, &counts.counting, &counts.pass, &counts.degraded,
                              &counts.fail, &counts.answers, &counts.frames, &counts.notes})
    *count = row.integer(column++);
  return counts;
}

std::string summary_of(const SessionCounts& counts) {
  return counts.participant + ": " + counts.state + "; the database holds " + number(counts.done) + " of " +
         number(counts.units) + " steps done, " + number(counts.answered) + " of " + number(counts.trials) +
         " trials answered, " + number(counts.excluded) + " excluded, " + number(counts.answers) +
         " answers, " + number(counts.notes) + " notes\n  showings: " + number(counts.showings) + ", " +
         number(counts.counting) + " of them count, " + number(counts.cut) +
         " cut short; timing: " + number(counts.pass) + " pass, " + number(counts.degraded) + " degraded, " +
         number(counts.fail) + " fail; " + number(counts.frames) + " frames\n";
}

}  // namespace study
