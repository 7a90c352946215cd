#include "libstudy/store/rating_table.hpp"

#include <array>

namespace study {

namespace {

constexpr std::array columns{
    RatingColumn{"trial_id", "trial", "trial_id"},
    RatingColumn{"protocol", "protocol", "name"},
    RatingColumn{"protocol_version", "protocol", "version"},
    RatingColumn{"participant", "session", "participant"},
    RatingColumn{"visit", "session", "visit"},
    RatingColumn{"test_data", "session", "test_data"},
    RatingColumn{"observer", "session", "observer"},
    RatingColumn{"clock", "session", "clock"},
    RatingColumn{"position", "trial", "position"},
    RatingColumn{"practice", "trial", "practice"},
    RatingColumn{"nominal_mean_fps", "trial", "nominal_mean_fps"},
    RatingColumn{"nominal_sd_fps", "trial", "nominal_sd_fps"},
    RatingColumn{"duration_s", "trial", "duration_s"},
    RatingColumn{"question", "question", "code"},
    RatingColumn{"score", "response", "score"},
    RatingColumn{"response_time_s", "response", "response_time_s"},
    RatingColumn{"attempt", "presentation", "attempt"},
    RatingColumn{"verdict", "presentation", "verdict"},
    RatingColumn{"grade", "presentation", "grade"},
    RatingColumn{"frames", "presentation", "frames"},
    RatingColumn{"mean_fps", "presentation", "mean_fps"},
    RatingColumn{"mean_arithmetic_fps", "presentation", "mean_arithmetic_fps"},
    RatingColumn{"sd_fps", "presentation", "sd_fps"},
    RatingColumn{"p95_ms", "presentation", "p95_ms"},
    RatingColumn{"longest_ms", "presentation", "longest_ms"},
    RatingColumn{"shortest_ms", "presentation", "shortest_ms"},
    RatingColumn{"lag1", "presentation", "lag1"},
    RatingColumn{"late_frames", "presentation", "late_frames"},
    RatingColumn{"worst_late_ms", "presentation", "worst_late_ms"},
};

}  // namespace

std::span<const RatingColumn> rating_columns() { return columns; }

std::string rating_table_sql() {
  std::string list;
  for (const RatingColumn& column : columns) {
    list +=
        (list.empty() ? "" : ", ") + std::string(column.table) + '.' + column.column + " AS " + column.name;
  }
  return "SELECT " + list +
         " FROM trial JOIN session USING (session_id) JOIN protocol USING (protocol_id) "
         "JOIN question USING (protocol_id) "
         "LEFT JOIN response ON response.trial_id = trial.trial_id "
         "AND response.question_id = question.question_id "
         "LEFT JOIN presentation ON presentation.presentation_id = response.presentation_id "
         "ORDER BY trial.trial_id, question.question_id";
}

}  // namespace study
