#include "libstudy/store/ratings.hpp"

#include "libstudy/store/database.hpp"
#include "libstudy/store/names.hpp"

namespace study {

using sqlite::Statement;

namespace {

constexpr const char* ratings_sql =
    "SELECT s.participant, p.name, p.sha256, s.test_data OR p.test_data, u.kind, t.position, "
    "c.mean_fps, c.sd_fps, c.duration_s, q.scale_min, q.scale_max, a.score, "
    "v.verdict, v.grade, v.reason, v.frames, v.mean_fps, v.mean_arithmetic_fps, v.sd_fps, v.longest_ms, "
    "v.shortest_ms, v.p95_ms, v.lag1, v.late_frames, v.worst_late_ms, coalesce(s.observer, ''), q.code, "
    "t.excluded IS NOT NULL "
    "FROM judgement j JOIN trial t USING (trial_id) JOIN unit u ON u.unit_id = j.unit_id "
    "JOIN session s ON s.session_id = t.session_id JOIN protocol p USING (protocol_id) "
    "JOIN cell c ON c.protocol_id = p.protocol_id AND c.cell = t.first_cell "
    "JOIN question q ON q.question_id = j.question_id AND q.kind = 'scale' AND q.personal = 0 "
    "LEFT JOIN response a ON a.response_id = j.response_id "
    "LEFT JOIN presentation v ON v.trial_id = t.trial_id AND v.interval = 0 AND v.state = 'played' "
    "AND v.attempt = j.attempt "
    "WHERE t.second_cell IS NULL ORDER BY p.protocol_id, s.participant, s.visit, t.position, j.place";

TimingVerdict read_verdict(const Statement& row, const FpsSetting& nominal) {
  TimingVerdict verdict;
  verdict.nominal = nominal;
  verdict.verdict = verdict_of(row.text(12));
  verdict.grade = grade_of(row.text(13));
  verdict.reason = row.text(14);
  verdict.realised.frames = static_cast<std::size_t>(row.integer(15));
  verdict.realised.mean = row.real(16);
  verdict.realised.mean_arithmetic = row.real(17);
  verdict.realised.sd = row.real(18);
  verdict.longest_ms = row.real(19);
  verdict.shortest_ms = row.real(20);
  verdict.p95_ms = row.real(21);
  verdict.lag1 = row.real(22);
  verdict.late = row.integer(23);
  verdict.worst_late_ms = row.real(24);
  return verdict;
}

}  // namespace

std::vector<RatingRow> read_ratings(const std::filesystem::path& path) {
  const auto database = open_database(path, sqlite::Open::Read, read_schema_steps());
  Statement row(*database, ratings_sql);
  std::vector<RatingRow> rows;
  while (row.step()) {
    RatingRow rating;
    rating.participant = row.text(0);
    rating.observer = row.text(25);
    rating.protocol_name = row.text(1);
    rating.protocol_sha256 = row.text(2);
    rating.test_data = row.integer(3) != 0;
    rating.practice = row.text(4) == "practice";
    rating.repeat = row.text(4) == "repeat";
    rating.question = row.text(26);
    rating.excluded = row.integer(27) != 0;
    rating.position = static_cast<int>(row.integer(5));
    rating.nominal = {row.real(6), row.real(7), row.real(8)};
    rating.scale_min = static_cast<int>(row.integer(9));
    rating.scale_max = static_cast<int>(row.integer(10));
    if (!row.is_null(11)) rating.rating = static_cast<int>(row.integer(11));
    if (!row.is_null(12)) rating.timing = read_verdict(row, rating.nominal);
    rows.push_back(std::move(rating));
  }
  return rows;
}

}  // namespace study
