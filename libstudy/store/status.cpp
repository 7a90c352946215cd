#include "libstudy/store/status.hpp"

#include "libstudy/store/database.hpp"

namespace study {

using sqlite::Statement;

namespace {

constexpr const char* protocols_sql =
    "SELECT p.protocol_id, p.name, p.version, p.sha256, p.text, p.trial_seconds, p.test_data, "
    "count(DISTINCT s.session_id), count(t.trial_id), count(t.trial_id) FILTER (WHERE t.state = 'answered') "
    "FROM protocol p LEFT JOIN session s USING (protocol_id) LEFT JOIN trial t USING (session_id) "
    "GROUP BY p.protocol_id ORDER BY p.protocol_id";

constexpr const char* sessions_sql =
    "SELECT s.protocol_id, s.participant, s.visit, coalesce(s.observer, ''), s.clock, s.test_data, "
    "count(t.trial_id), count(t.trial_id) FILTER (WHERE t.state = 'answered'), "
    "(SELECT count(*) FROM presentation p JOIN trial u USING (trial_id) "
    "WHERE u.session_id = s.session_id AND p.state = 'interrupted'), s.ended_utc IS NOT NULL "
    "FROM session s LEFT JOIN trial t USING (session_id) "
    "GROUP BY s.session_id ORDER BY s.protocol_id, s.session_id";

std::string certificate_sql(FpsMean mean) {
  const std::string realised = mean == FpsMean::Harmonic ? "p.mean_fps" : "p.mean_arithmetic_fps";
  return "SELECT t.nominal_mean_fps, t.nominal_sd_fps, max(t.duration_s), count(*), avg(" + realised +
         "), max(abs(" + realised +
         " - t.nominal_mean_fps)), avg(p.sd_fps), max(abs(p.sd_fps - t.nominal_sd_fps)), "
         "sum(p.frames), sum(p.late_frames), max(p.worst_late_ms), count(*) FILTER (WHERE p.verdict = "
         "'pass'), "
         "count(*) FILTER (WHERE p.verdict = 'degraded'), count(*) FILTER (WHERE p.verdict = 'fail'), "
         "group_concat(DISTINCT p.grade) FROM response r JOIN presentation p USING (presentation_id) "
         "JOIN trial t ON t.trial_id = r.trial_id JOIN session s USING (session_id) "
         "WHERE s.run_id = ? GROUP BY t.setting ORDER BY t.setting";
}

}  // namespace

StudyStatus read_status(const std::filesystem::path& path) {
  const auto database = open_database(path, sqlite::Open::Read, read_schema_steps());
  StudyStatus status;
  for (Statement row(*database, protocols_sql); row.step();) {
    ProtocolRow protocol{row.integer(0),      row.text(1),    row.text(2),    row.text(3),   row.text(4), {},
                         row.integer(6) != 0, row.integer(7), row.integer(8), row.integer(9)};
    if (!row.is_null(5)) protocol.trial_seconds = row.real(5);
    status.protocols.push_back(std::move(protocol));
  }
  for (Statement row(*database, sessions_sql); row.step();) {
    status.sessions.push_back({row.integer(0), row.text(1), static_cast<int>(row.integer(2)), row.text(3),
                               row.text(4), row.integer(5) != 0, row.integer(6), row.integer(7),
                               row.integer(8), row.integer(9) != 0});
  }
  status.frames = database->integer("SELECT count(*) FROM frame");
  return status;
}

std::vector<CertificateRow> read_certificate(const std::filesystem::path& path, std::int64_t run_id,
                                             FpsMean mean) {
  const auto database = open_database(path, sqlite::Open::Read, read_schema_steps());
  Statement row(*database, certificate_sql(mean));
  row.bind(0, run_id);
  std::vector<CertificateRow> rows;
  while (row.step()) {
    CertificateRow line;
    line.nominal = {row.real(0), row.real(1), row.real(2)};
    line.trials = row.integer(3);
    line.mean = row.real(4);
    line.mean_worst = row.real(5);
    line.sd = row.real(6);
    line.sd_worst = row.real(7);
    line.frames = row.integer(8);
    line.late = row.integer(9);
    line.worst_late_ms = row.real(10);
    line.pass = row.integer(11);
    line.degraded = row.integer(12);
    line.fail = row.integer(13);
    line.grades = row.text(14);
    rows.push_back(std::move(line));
  }
  return rows;
}

}  // namespace study
