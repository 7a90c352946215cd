
#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/ptpe/estimates_json.hpp"
#include "libstudy/analysis/ptpe/pilot_fit.hpp"
#include "libstudy/analysis/ptpe/pilot_people_json.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/gsl_errors.hpp"
#include "stats/inference/describe.hpp"
#include "stats/mean_interval.hpp"

namespace study {

namespace {

constexpr const char* least_squares =
    "least squares of all ratings (a participant's mean of each setting): E[score] = level + k u + m u delta "
    "+ "
    "q u^2, u = log mu - log a - b delta, at ";
constexpr const char* direct_interval =
    "jackknife over participants with Student's t, for a on the log scale";

/// Name of the method that gave the intervals of a and b in the main estimate.
std::string interval_method(const MainEstimate& main) {
  if (main.spread && !main.spread->spans_contour) return direct_interval;
  return std::string("the range that two intervals span together: the direct estimate's (") +
         direct_interval + ") and the contour's (expanded percentile bootstrap over participants)";
}
constexpr const char* mean_caveat =
    "The paper does not say which mean its 23.68 and 0.02 refer to; settings drawn with a given arithmetic "
    "mean run "
    "at a lower harmonic one. The solver's tau uses the harmonic mean.";

/// A list with one entry for each level: the paper's estimate, and within it as "direct" the direct estimate.
Json levels_json(const std::map<double, LevelFit>& estimates) {
  Json list = Json::array();
  for (const auto& [level, estimate] : estimates) {
    Json json{{"level", level}, {"estimator", "contour"}};
    json.update(contour_estimate_json(estimate.contour));
    json["direct"] = direct_json(estimate.direct);
    list.push_back(json);
  }
  return list;
}

/// A list with one entry for each setting (mean mu and standard deviation delta of the frame rate), made from
/// the participants' mean scores at this setting.
Json cells_json(const PilotFit& fit) {
  const auto& grid = fit.grid;
  Json cells = Json::array();
  for (std::size_t row = 0; row < grid.mu.size(); ++row) {
    for (std::size_t column = 0; column < grid.delta.size(); ++column) {
      const auto& node = grid.at(row, column);
      if (!node) continue;
      const auto& scores = fit.scores[row * grid.delta.size() + column];
      const auto about = stats::mean_interval(scores, fit.bootstrap.confidence);
      const auto described = stats::describe(scores);
      cells.push_back({{"fps_mean", grid.mu[row]},
                       {"fps_sd", grid.delta[column]},
                       {"realised_mean", node->mu},
                       {"realised_sd", node->delta},
                       {"score", node->score},
                       {"n", scores.size()},
                       {"sd", described ? json_number(described->sd) : Json()},
                       {"ci", scores.size() > 1 ? Json{about.low, about.high} : Json()}});
    }
  }
  return cells;
}

/// The protocol, the question, counts of analysed showings by timing verdict and by grade, and counts of data
/// that are left out: answers excluded by rule, trials of practice, repeats and trials without an answer, and
/// sessions of test data and observer models.
Json data_json(const TaskData& data) {
  std::map<std::string, int> verdicts, grades, rules;
  for (const auto& one : data.showings) {
    if (!one.analysed) continue;
    ++verdicts[one.shown.verdict  ? verdict_name(*one.shown.verdict)
               : one.shown.framed ? "unjudged"
                                  : "not recorded"];
    if (one.shown.framed) ++grades[std::string(1, static_cast<char>(one.shown.grade))];
  }
  for (const auto& one : data.exclusions) rules[one.rule] += one.answers;
  Json json{{"protocol", {{"name", data.protocol.name}, {"sha256", data.protocol.sha256}}},
            {"question", data.question.id},
            {"test_data", data.test_data},
            {"simulated_participants", data.simulated.size()},
            {"used", {{"by_verdict", verdicts}, {"by_grade", grades}}},
            {"excluded",
             {{"answers_by_rule", rules},
              {"practice", data.flow.practice},
              {"repeat", data.flow.repeat},
              {"unanswered", data.flow.trials_planned - data.flow.trials_answered},
              {"sessions_of_test_data", data.flow.test_left_out},
              {"sessions_simulated", data.flow.simulated_left_out}}}};
  if (!data.imported.empty()) json["imported"] = data.imported;
  return json;
}

void add_provenance(Json& json) {
  json["versions"] = {{"vip_lab", base::version()}, {"gsl", stats::gsl_library_version()}};
  json["date_utc"] = base::utc_now();
}

}  // namespace

Json failed_fit_json(std::optional<double> level, const std::string& reason) {
  Json json{{"format", 1}, {"status", "failed"}, {"reason", reason}, {"level", json_number(level)}};
  add_estimate(json, {stats::Refusal{reason}, stats::Refusal{reason}});
  json["n_participants"] = 0;
  json["n_ratings"] = 0;
  json["flags"] = Json::array();
  add_provenance(json);
  return json;
}

Json fit_json(const PilotFit& fit) {
  Json json{{"format", 1},
            {"status", fit.ok() ? "ok" : "failed"},
            {"reason", fit.reason},
            {"level", fit.level},
            {"fps_mean", "harmonic"}};
  add_estimate(json, fit.main());
  json["n_participants"] = fit.participants;
  json["n_ratings"] = fit.data.ratings.size();
  json["n_settings"] = fit.settings;
  json["flags"] = Json::array();
  for (const auto& flag : fit.flags) json["flags"].push_back({{"code", flag.code}, {"text", flag.text}});
  json["doubts"] = Json::array();
  for (const auto& doubt : fit.doubts) json["doubts"].push_back(doubt.code);
  const int unframed = fit.data.stated_rates + fit.data.asked_rates;
  const std::string rates = unframed > 0 ? fit.data.rates_words() : "realised";
  json["estimator"] = least_squares + rates + " mu and delta";
  if (unframed > 0) json["rates"] = rates;
  json["interval"] = {{"method", interval_method(fit.main())}, {"confidence", fit.bootstrap.confidence}};
  json["bootstrap"] = {{"resamples", fit.bootstrap.resamples}, {"seed", fit.bootstrap.seed}};
  json["scale_min"] = fit.data.question.scale_min;
  json["scale_max"] = fit.data.question.scale_max;
  if (fit.ok()) json["relative_half_width"] = fit.relative_half_width();
  if (fit.harmonic.contains(5.0)) json["level5"] = direct_json(fit.harmonic.at(5.0).direct);
  json["estimators"] = estimators_json(fit);
  json["form"] = form_json(fit);
  json["raters"] = raters_json(fit);
  json["lack_of_fit"] = lack_of_fit_json(fit.chosen().direct);
  json["bands"] = bands_json(fit);
  json["means"] = {{"note", mean_caveat},
                   {"harmonic", levels_json(fit.harmonic)},
                   {"arithmetic", levels_json(fit.arithmetic)}};
  json.update(data_json(fit.data));
  json["cells"] = cells_json(fit);
  add_provenance(json);
  return json;
}

}  // namespace study
