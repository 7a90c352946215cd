#include "libstudy/store/export/rating_table.hpp"

#include <array>

#include "libstudy/store/read/run_settings.hpp"

namespace study {

namespace {

constexpr std::array columns{
    RatingColumn{"trial_id", "trial", "trial", "trial_id"},
    RatingColumn{"protocol", "protocol", "protocol", "name"},
    RatingColumn{"protocol_version", "protocol", "protocol", "version"},
    RatingColumn{"participant", "session", "session", "participant"},
    RatingColumn{"visit", "session", "session", "visit"},
    RatingColumn{"test_data", "session", "session", "test_data"},
    RatingColumn{"observer", "session", "session", "observer"},
    RatingColumn{"clock", "session", "session", "clock"},
    RatingColumn{"station", "session", "session", "station"},
    RatingColumn{"gaze_source", "session", "session", "gaze_source",
                 "coalesce(shown_1.gaze_source, session.gaze_source)",
                 "what the fluid followed: tracked, head, mouse, fixed, fixation or none", "TEXT"},
    RatingColumn{"setting_sha256", "session", "session", "run_id", setting_sha256_sql, setting_sha256_meaning,
                 "TEXT"},
    RatingColumn{"position", "trial", "trial", "position"},
    RatingColumn{"block", "unit", "unit", "block"},
    RatingColumn{"block_kind", "unit", "unit", "kind"},
    RatingColumn{"group_index", "trial", "trial", "group_index"},
    RatingColumn{"first_scene", "cell_1", "cell", "scene"},
    RatingColumn{"first_method", "cell_1", "cell", "method"},
    RatingColumn{"first_n_star", "cell_1", "cell", "n_star"},
    RatingColumn{"first_effects", "cell_1", "cell", "effects"},
    RatingColumn{"first_nominal_mean_fps", "cell_1", "cell", "mean_fps"},
    RatingColumn{"first_nominal_sd_fps", "cell_1", "cell", "sd_fps"},
    RatingColumn{"first_duration_s", "cell_1", "cell", "duration_s"},
    RatingColumn{"second_scene", "cell_2", "cell", "scene"},
    RatingColumn{"second_method", "cell_2", "cell", "method"},
    RatingColumn{"second_n_star", "cell_2", "cell", "n_star"},
    RatingColumn{"second_effects", "cell_2", "cell", "effects"},
    RatingColumn{"second_nominal_mean_fps", "cell_2", "cell", "mean_fps"},
    RatingColumn{"second_nominal_sd_fps", "cell_2", "cell", "sd_fps"},
    RatingColumn{"second_duration_s", "cell_2", "cell", "duration_s"},
    RatingColumn{"question", "question", "question", "code"},
    RatingColumn{"score", "response", "response", "score"},
    RatingColumn{"response_time_s", "response", "response", "response_time_s"},
    RatingColumn{"input", "response", "response", "input"},
    RatingColumn{
        "attempt", "response", "response", "attempt", "judgement.attempt",
        "showing of the trial that was judged; without an answer the last one played and not set aside"},
    RatingColumn{"counts", "response", "response", "score", "judgement.counts",
                 "1: the answer counts, 0: why_not says why"},
    RatingColumn{"why_not", "trial", "trial", "excluded", "judgement.why_not",
                 "not answered, excluded (by the experimenter) or practice; empty: the answer counts",
                 "TEXT"},
    RatingColumn{"excluded", "trial", "trial", "excluded", "trial.excluded IS NOT NULL",
                 "1: excluded by the experimenter"},
    RatingColumn{"first_verdict", "shown_1", "presentation", "verdict"},
    RatingColumn{"first_grade", "shown_1", "presentation", "grade"},
    RatingColumn{"first_frames", "shown_1", "presentation", "frames"},
    RatingColumn{"first_mean_fps", "shown_1", "presentation", "mean_fps"},
    RatingColumn{"first_mean_arithmetic_fps", "shown_1", "presentation", "mean_arithmetic_fps"},
    RatingColumn{"first_sd_fps", "shown_1", "presentation", "sd_fps"},
    RatingColumn{"first_p95_ms", "shown_1", "presentation", "p95_ms"},
    RatingColumn{"first_longest_ms", "shown_1", "presentation", "longest_ms"},
    RatingColumn{"first_shortest_ms", "shown_1", "presentation", "shortest_ms"},
    RatingColumn{"first_lag1", "shown_1", "presentation", "lag1"},
    RatingColumn{"first_late_frames", "shown_1", "presentation", "late_frames"},
    RatingColumn{"first_worst_late_ms", "shown_1", "presentation", "worst_late_ms"},
    RatingColumn{"first_active_fraction", "shown_1", "presentation", "presentation_id",
                 "(SELECT active_fraction FROM solving v WHERE v.presentation_id = shown_1.presentation_id)",
                 showing_active_meaning, "REAL"},
    RatingColumn{"first_tau_fps", "shown_1", "presentation", "presentation_id",
                 "(SELECT tau_fps FROM solving v WHERE v.presentation_id = shown_1.presentation_id)",
                 showing_tau_meaning, "REAL"},
    RatingColumn{"second_verdict", "shown_2", "presentation", "verdict"},
    RatingColumn{"second_grade", "shown_2", "presentation", "grade"},
    RatingColumn{"second_frames", "shown_2", "presentation", "frames"},
    RatingColumn{"second_mean_fps", "shown_2", "presentation", "mean_fps"},
    RatingColumn{"second_mean_arithmetic_fps", "shown_2", "presentation", "mean_arithmetic_fps"},
    RatingColumn{"second_sd_fps", "shown_2", "presentation", "sd_fps"},
    RatingColumn{"second_p95_ms", "shown_2", "presentation", "p95_ms"},
    RatingColumn{"second_longest_ms", "shown_2", "presentation", "longest_ms"},
    RatingColumn{"second_shortest_ms", "shown_2", "presentation", "shortest_ms"},
    RatingColumn{"second_lag1", "shown_2", "presentation", "lag1"},
    RatingColumn{"second_late_frames", "shown_2", "presentation", "late_frames"},
    RatingColumn{"second_worst_late_ms", "shown_2", "presentation", "worst_late_ms"},
    RatingColumn{"second_active_fraction", "shown_2", "presentation", "presentation_id",
                 "(SELECT active_fraction FROM solving v WHERE v.presentation_id = shown_2.presentation_id)",
                 showing_active_meaning, "REAL"},
    RatingColumn{"second_tau_fps", "shown_2", "presentation", "presentation_id",
                 "(SELECT tau_fps FROM solving v WHERE v.presentation_id = shown_2.presentation_id)",
                 showing_tau_meaning, "REAL"},
};

constexpr const char* joined_tables =
    " FROM judgement JOIN trial USING (trial_id) JOIN unit ON unit.unit_id = judgement.unit_id "
    "JOIN session ON session.session_id = trial.session_id JOIN protocol USING (protocol_id) "
    "JOIN question ON question.question_id = judgement.question_id AND question.personal = 0 "
    "JOIN cell AS cell_1 ON cell_1.protocol_id = protocol.protocol_id AND cell_1.cell = trial.first_cell "
    "LEFT JOIN cell AS cell_2 ON cell_2.protocol_id = protocol.protocol_id "
    "AND cell_2.cell = trial.second_cell "
    "LEFT JOIN response ON response.response_id = judgement.response_id "
    "LEFT JOIN presentation AS shown_1 ON shown_1.trial_id = trial.trial_id "
    "AND shown_1.attempt = judgement.attempt AND shown_1.interval = 0 "
    "LEFT JOIN presentation AS shown_2 ON shown_2.trial_id = trial.trial_id "
    "AND shown_2.attempt = judgement.attempt AND shown_2.interval = 1";

}  // namespace

std::span<const RatingColumn> rating_columns() { return columns; }

std::string rating_subject(const RatingColumn& column) {
  const std::string from = column.from;
  if (from.ends_with("_1")) return "first or only stimulus: ";
  return from.ends_with("_2") ? "second stimulus of a pair: " : "";
}

std::string rating_table_sql(const std::string& condition) {
  std::string list;
  for (const RatingColumn& column : columns) {
    const std::string value =
        column.expression ? column.expression : std::string(column.from) + '.' + column.column;
    list += (list.empty() ? "" : ", ") + value + " AS " + column.name;
  }
  return "SELECT " + list + joined_tables + " WHERE " + condition +
         " ORDER BY trial.trial_id, judgement.place";
}

}  // namespace study
