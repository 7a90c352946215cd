#include "libstudy/store/read/status.hpp"

#include <algorithm>

#include "libstudy/store/names.hpp"
#include "libstudy/store/open_study.hpp"

namespace study {

using sqlite::Statement;

namespace {

constexpr const char* status_protocols_sql =
    "SELECT p.protocol_id, p.name, p.version, p.sha256, p.text, p.trial_seconds, p.test_data, "
    "count(DISTINCT s.session_id), count(t.trial_id), count(t.trial_id) FILTER (WHERE t.state = 'answered') "
    "FROM protocol p LEFT JOIN session s USING (protocol_id) LEFT JOIN trial t USING (session_id) "
    "GROUP BY p.protocol_id ORDER BY p.protocol_id";

constexpr const char* status_sessions_sql =
    "SELECT s.protocol_id, s.participant, s.visit, coalesce(s.observer, ''), s.clock, s.test_data, "
    "count(t.trial_id), count(t.trial_id) FILTER (WHERE t.state = 'answered'), "
    "(SELECT count(*) FROM presentation p JOIN trial v USING (trial_id) "
    "WHERE v.session_id = s.session_id AND p.state = 'interrupted'), s.ended_utc IS NOT NULL, s.state, "
    "count(u.unit_id), count(u.unit_id) FILTER (WHERE u.state = 'done'), count(t.excluded), "
    "(SELECT granted FROM permission a WHERE a.session_id = s.session_id AND a.what = 'gaze'), "
    "(SELECT granted FROM permission a WHERE a.session_id = s.session_id AND a.what = 'sharing'), "
    "coalesce(s.imported_from, ''), coalesce(s.source_sha256, ''), "
    "(SELECT count(*) FROM presentation p JOIN trial v USING (trial_id) WHERE v.session_id = s.session_id "
    "AND p.state = 'played' AND p.frames IS NULL), "
    "(SELECT count(*) FROM presentation p JOIN trial v USING (trial_id) WHERE v.session_id = s.session_id "
    "AND p.state = 'played' AND p.frames IS NULL AND p.mean_fps IS NOT NULL), "
    "(SELECT count(*) FROM presentation p JOIN trial v USING (trial_id) WHERE v.session_id = s.session_id "
    "AND p.state = 'played') "
    "FROM session s LEFT JOIN unit u USING (session_id) LEFT JOIN trial t USING (trial_id) "
    "GROUP BY s.session_id ORDER BY s.protocol_id, s.session_id";

constexpr const char* cell_counts_sql =
    "WITH shown AS (SELECT t.first_cell, t.second_cell, t.state = 'answered' AS answered FROM trial t "
    "JOIN session s USING (session_id) JOIN unit u USING (trial_id) "
    "WHERE s.protocol_id = ?1 AND u.kind = 'stimulus'), "
    "counted AS (SELECT cell, count(*) AS trials, sum(answered) AS answered FROM "
    "(SELECT first_cell AS cell, answered FROM shown UNION ALL SELECT second_cell, answered FROM shown) "
    "GROUP BY cell) "
    "SELECT c.levels, coalesce(n.trials, 0), coalesce(n.answered, 0) FROM cell c "
    "LEFT JOIN counted n ON n.cell = c.cell WHERE c.protocol_id = ?1 AND c.levels IS NOT NULL ORDER BY "
    "c.cell";

/// SQL that selects the timing certificate's lines, one per cell. of: the column, s.run_id or s.protocol_id,
/// whose value (the parameter of the SQL) selects the sessions.
std::string certificate_sql(FpsMean mean, const std::string& of) {
  const std::string realised = mean == FpsMean::Harmonic ? "p.mean_fps" : "p.mean_arithmetic_fps";
  return "SELECT c.scene, c.method, c.n_star, c.mean_fps, c.sd_fps, c.duration_s, count(*), avg(" + realised +
         "), max(abs(" + realised +
         " - c.mean_fps)), avg(p.sd_fps), max(abs(p.sd_fps - c.sd_fps)), "
         "sum(p.frames), sum(p.late_frames), max(p.worst_late_ms), "
         "count(*) FILTER (WHERE p.verdict = 'pass'), count(*) FILTER (WHERE p.verdict = 'degraded'), "
         "count(*) FILTER (WHERE p.verdict = 'fail'), group_concat(DISTINCT e.grade), coalesce(c.effects, "
         "''), coalesce(c.levels, ''), coalesce(c.timing, ''), coalesce(avg(p.p99_ms), 0), "
         "max(p.longest_ms), coalesce(avg(p.hitches), 0), avg(p.animation_error_ms) "
         "FROM presentation p JOIN trial t USING (trial_id) "
         "JOIN session s USING (session_id) JOIN cell c ON c.protocol_id = s.protocol_id AND c.cell = p.cell "
         "JOIN showing w USING (presentation_id) JOIN evidence e USING (presentation_id) WHERE " +
         of +
         " = ? AND w.judged AND p.frames IS NOT NULL "
         "GROUP BY c.protocol_id, c.cell ORDER BY c.protocol_id, c.cell";
}

/// Sorts grades, given as "D,A", alphabetically, so that the best grade comes first: "A,D".
std::string sorted_grades(std::string grades) {
  std::sort(grades.begin(), grades.end());
  std::string out;
  for (const char grade : grades) {
    if (grade != ',') out += (out.empty() ? "" : ",") + std::string(1, grade);
  }
  return out;
}

std::vector<CertificateRow> certificate_rows(sqlite::Connection& database, FpsMean mean,
                                             const std::string& of, std::int64_t id) {
  Statement row(database, certificate_sql(mean, of));
  row.bind_all(id);
  std::vector<CertificateRow> rows;
  while (row.step()) {
    CertificateRow line;
    line.what = {row.text(0), row.text(1), row.text(2), row.text(18)};
    line.nominal = {row.real(3), row.real(4), row.real(5)};
    line.trials = row.integer(6);
    line.mean = row.real(7);
    line.mean_worst = row.real(8);
    line.sd = row.real(9);
    line.sd_worst = row.real(10);
    line.frames = row.integer(11);
    line.late = row.integer(12);
    line.worst_late_ms = row.real(13);
    line.pass = row.integer(14);
    line.degraded = row.integer(15);
    line.fail = row.integer(16);
    line.grades = sorted_grades(row.text(17));
    line.levels = factor_levels(row.text(19));
    line.timing = row.text(20);
    line.p99_ms = row.real(21);
    line.longest_ms = row.real(22);
    line.hitches = row.real(23);
    if (!row.is_null(24)) line.animation_error_ms = row.real(24);
    rows.push_back(std::move(line));
  }
  return rows;
}

std::optional<bool> flag(const Statement& row, int column) {
  if (row.is_null(column)) return {};
  return row.integer(column) != 0;
}

}  // namespace

StudyStatus read_status(const StudyFile& study) {
  auto [database, lacking] = open_study(study);
  StudyStatus status;
  status.lacking = std::move(lacking);
  for (Statement row(*database, status_protocols_sql); row.step();) {
    ProtocolRow protocol{.id = row.integer(0),
                         .name = row.text(1),
                         .version = row.text(2),
                         .sha256 = row.text(3),
                         .text = row.text(4),
                         .trial_seconds = {},
                         .test_data = row.integer(6) != 0,
                         .sessions = row.integer(7),
                         .trials = row.integer(8),
                         .answered = row.integer(9)};
    if (!row.is_null(5)) protocol.trial_seconds = row.real(5);
    Statement cell(*database, cell_counts_sql);
    for (cell.bind_all(protocol.id); cell.step();)
      protocol.cells.push_back({factor_levels(cell.text(0)), cell.integer(1), cell.integer(2)});
    status.protocols.push_back(std::move(protocol));
  }
  for (Statement row(*database, status_sessions_sql); row.step();) {
    status.sessions.push_back({.protocol_id = row.integer(0),
                               .participant = row.text(1),
                               .visit = static_cast<int>(row.integer(2)),
                               .observer = row.text(3),
                               .clock = row.text(4),
                               .test_data = row.integer(5) != 0,
                               .trials = row.integer(6),
                               .answered = row.integer(7),
                               .interrupted = row.integer(8),
                               .ended = row.integer(9) != 0,
                               .state = row.text(10),
                               .units = row.integer(11),
                               .done = row.integer(12),
                               .excluded = row.integer(13),
                               .gaze = flag(row, 14),
                               .sharing = flag(row, 15),
                               .imported_from = row.text(16),
                               .source_sha256 = row.text(17),
                               .not_recorded = row.integer(18),
                               .stated = row.integer(19),
                               .showings = row.integer(20)});
  }
  for (Statement row(*database, "SELECT participant FROM tombstone ORDER BY participant"); row.step();)
    status.withdrawn.push_back(row.text(0));
  status.frames = database->integer("SELECT count(*) FROM frame");
  status.gaze = database->integer("SELECT count(*) FROM gaze");
  return status;
}

std::vector<CertificateRow> read_certificate(const std::filesystem::path& path, std::int64_t run_id,
                                             FpsMean mean) {
  return certificate_rows(*open_study(path).database, mean, "s.run_id", run_id);
}

std::vector<CertificateRow> read_certificate_of_protocol(const StudyFile& study, std::int64_t protocol_id,
                                                         FpsMean mean) {
  return certificate_rows(*open_study(study).database, mean, "s.protocol_id", protocol_id);
}

}  // namespace study
