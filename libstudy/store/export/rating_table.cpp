#include "libstudy/store/export/rating_table.hpp"

#include <algorithm>

#include "libstudy/store/names.hpp"
#include "libstudy/store/read/run_settings.hpp"

namespace study {

using sqlite::Connection;
using sqlite::Statement;

namespace {

const std::vector<RatingColumn> fixed_columns{
    RatingColumn{"trial_id", "trial", "trial", "trial_id"},
    RatingColumn{"protocol", "protocol", "protocol", "name"},
    RatingColumn{"protocol_version", "protocol", "protocol", "version"},
    RatingColumn{"participant", "session", "session", "participant"},
    RatingColumn{"visit", "session", "session", "visit"},
    RatingColumn{"test_data", "session", "session", "test_data"},
    RatingColumn{"observer", "session", "session", "observer"},
    RatingColumn{"clock", "session", "session", "clock"},
    RatingColumn{"station", "session", "session", "station"},
    RatingColumn{"imported_from", "session", "session", "imported_from"},
    RatingColumn{"source_sha256", "session", "session", "source_sha256"},
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
    RatingColumn{"first_grade", "shown_1", "presentation", "grade",
                 "(SELECT grade FROM evidence v WHERE v.presentation_id = shown_1.presentation_id)",
                 showing_grade_meaning, "TEXT"},
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
    RatingColumn{"second_grade", "shown_2", "presentation", "grade",
                 "(SELECT grade FROM evidence v WHERE v.presentation_id = shown_2.presentation_id)",
                 showing_grade_meaning, "TEXT"},
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

/// A text as a literal of SQL.
std::string sql_text(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "''" : std::string(1, c);
  return out + "'";
}

/// Makes a column's name from a factor's name: its letters, digits and '_', with "_level" behind them while
/// `taken` has the name. Adds the name to `taken`.
std::string column_name(const std::string& factor, std::set<std::string>& taken) {
  std::string name;
  for (const char c : factor) {
    if ((c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_') name += c;
  }
  if (name.empty()) name = "factor";
  while (!taken.insert(name).second) name += "_level";
  return name;
}

/// Adds the columns that only protocols with factors have, about one stimulus of a trial. prefix begins the
/// columns' names ("first_" or "second_"); cell and shown: the stimulus's cell and presentation in the SQL.
void add_factor_columns(const std::vector<FactorColumn>& factors, const std::string& prefix,
                        const std::string& cell, const std::string& shown, std::vector<RatingColumn>& out) {
  for (const FactorColumn& one : factors)
    out.push_back({prefix + one.name, cell, "cell", "levels", one.level_sql(cell), one.meaning, "TEXT"});
  out.push_back({prefix + "timing", cell, "cell", "timing"});
  for (const char* name : {"p99_ms", "hitches", "animation_error_ms"})
    out.push_back({prefix + name, shown, "presentation", name});
}

}  // namespace

std::string FactorColumn::level_sql(const std::string& cell) const {
  // The column `levels` has one line "factor = level" for each factor. A line begins at the text's start or
  // after a line end (char(10)).
  const std::string lines = "(char(10) || " + cell + ".levels || char(10))";
  const std::string key = "(char(10) || " + sql_text(factor + " = ") + ")";
  const std::string rest = "substr(" + lines + ", instr(" + lines + ", " + key + ") + length(" + key + "))";
  return "(CASE WHEN instr(" + lines + ", " + key + ") > 0 THEN substr(" + rest + ", 1, instr(" + rest +
         ", char(10)) - 1) END)";
}

std::vector<FactorColumn> factor_columns(Connection& database, const std::string& condition,
                                         std::set<std::string> taken) {
  std::vector<FactorColumn> out;
  // The first cell names all factors of its protocol.
  Statement row(database,
                "SELECT levels FROM cell WHERE cell = 0 AND levels IS NOT NULL AND protocol_id IN "
                "(SELECT session.protocol_id FROM session WHERE " +
                    condition + ") ORDER BY protocol_id");
  while (row.step()) {
    for (const auto& one : factor_levels(row.text(0))) {
      const std::string& factor = one.first;
      const auto known = std::find_if(out.begin(), out.end(),
                                      [&](const FactorColumn& column) { return column.factor == factor; });
      if (known == out.end())
        out.push_back({column_name(factor, taken), factor,
                       "level of the factor " + factor + "; empty: the protocol has no such factor"});
    }
  }
  return out;
}

std::vector<RatingColumn> rating_columns(Connection& database, const std::string& condition) {
  std::vector<RatingColumn> out = fixed_columns;
  std::set<std::string> taken{"timing", "p99_ms", "hitches", "animation_error_ms"};
  for (const RatingColumn& column : fixed_columns)
    if (column.name.starts_with("first_")) taken.insert(column.name.substr(6));
  const auto factors = factor_columns(database, condition, taken);
  if (factors.empty()) return out;
  add_factor_columns(factors, "first_", "cell_1", "shown_1", out);
  add_factor_columns(factors, "second_", "cell_2", "shown_2", out);
  return out;
}

std::string rating_subject(const RatingColumn& column) {
  if (column.from.ends_with("_1")) return "first or only stimulus: ";
  return column.from.ends_with("_2") ? "second stimulus of a pair: " : "";
}

std::string rating_table_sql(Connection& database, const std::string& condition) {
  std::string list;
  for (const RatingColumn& column : rating_columns(database, condition)) {
    const std::string value =
        column.expression.empty() ? column.from + '.' + column.column : column.expression;
    list += (list.empty() ? "" : ", ") + value + " AS " + column.name;
  }
  return "SELECT " + list + joined_tables + " WHERE " + condition +
         " ORDER BY trial.trial_id, judgement.place";
}

}  // namespace study
