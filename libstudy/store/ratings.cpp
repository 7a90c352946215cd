#include "libstudy/store/ratings.hpp"

#include "libstudy/store/database.hpp"
#include "libstudy/store/names.hpp"

namespace study {

using sqlite::Statement;

namespace {

// The presentation that counts is the one answered, or the last one played while there is no answer.
constexpr const char* ratings_sql =
    "SELECT s.participant, p.name, p.sha256, s.test_data OR p.test_data, t.practice, t.position, "
    "t.nominal_mean_fps, t.nominal_sd_fps, t.duration_s, q.scale_min, q.scale_max, a.score, "
    "c.verdict, c.grade, c.reason, c.frames, c.mean_fps, c.mean_arithmetic_fps, c.sd_fps, c.longest_ms, "
    "c.shortest_ms, c.p95_ms, c.lag1, c.late_frames, c.worst_late_ms, coalesce(s.observer, '') "
    "FROM trial t JOIN session s USING (session_id) JOIN protocol p USING (protocol_id) "
    "JOIN question q USING (protocol_id) "
    "LEFT JOIN response a ON a.trial_id = t.trial_id AND a.question_id = q.question_id "
    "LEFT JOIN presentation c ON c.presentation_id = coalesce(a.presentation_id, "
    "(SELECT max(l.presentation_id) FROM presentation l WHERE l.trial_id = t.trial_id AND l.state = "
    "'played')) "
    "ORDER BY p.protocol_id, s.participant, s.visit, t.position";

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
    rating.practice = row.integer(4) != 0;
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
