#include <nlohmann/json.hpp>

#include "apps/stats/estimates_json.hpp"
#include "apps/stats/pilot_fit.hpp"
#include "stats/base/file.hpp"
#include "stats/gsl_errors.hpp"

namespace apps {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* estimator =
    "least squares of all ratings (a participant's mean of each setting): E[score] = level + k u + m u delta "
    "+ "
    "q u^2, u = log mu - log a - b delta, at realised mu and delta";
constexpr const char* interval_method =
    "jackknife over participants with Student's t, for a on the log scale";
constexpr const char* mean_caveat =
    "The paper does not say which mean its 23.68 and 0.02 refer to; settings drawn with a given arithmetic "
    "mean run "
    "at a lower harmonic one. The solver's tau uses the harmonic mean.";

/// The paper's estimate at each level, the direct one with this mean inside.
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

Json cells_json(const stats::ScoreGrid& grid) {
  Json cells = Json::array();
  for (std::size_t row = 0; row < grid.mu.size(); ++row) {
    for (std::size_t column = 0; column < grid.delta.size(); ++column) {
      const auto& node = grid.at(row, column);
      if (!node) continue;
      cells.push_back({{"fps_mean", grid.mu[row]},
                       {"fps_sd", grid.delta[column]},
                       {"realised_mean", node->mu},
                       {"realised_sd", node->delta},
                       {"score", node->score}});
    }
  }
  return cells;
}

Json data_json(const PilotData& data) {
  return {{"protocol", {{"name", data.protocol_name}, {"sha256", data.protocol_sha256}}},
          {"test_data", data.test_data},
          {"simulated_participants", data.simulated_participants},
          {"used", {{"by_verdict", data.used_by_verdict}, {"by_grade", data.used_by_grade}}},
          {"excluded",
           {{"by_verdict", data.excluded_by_verdict},
            {"practice", data.practice},
            {"repeat", data.repeat},
            {"by_experimenter", data.excluded},
            {"unanswered", data.unanswered},
            {"test_data_beside_real", data.test_left_out},
            {"simulated_beside_people", data.simulated_left_out},
            {"without_timing", data.without_timing}}}};
}

void add_provenance(Json& json) {
  json["versions"] = {{"vip_lab", base::version()}, {"gsl", stats::gsl_library_version()}};
  json["date_utc"] = base::utc_now();
}

}  // namespace

Json failed_fit_json(double level, const std::string& reason) {
  Json json{{"format", 1}, {"status", "failed"}, {"reason", reason}, {"level", level}};
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
  json["estimator"] = estimator;
  json["interval"] = {{"method", interval_method}, {"confidence", fit.bootstrap.confidence}};
  json["bootstrap"] = {{"resamples", fit.bootstrap.resamples}, {"seed", fit.bootstrap.seed}};
  json["scale_min"] = fit.data.scale_min;
  json["scale_max"] = fit.data.scale_max;
  if (fit.ok()) json["relative_half_width"] = fit.relative_half_width();
  json["level5"] = direct_json(fit.harmonic.at(5.0).direct);
  json["estimators"] = estimators_json(fit);
  json["lack_of_fit"] = lack_of_fit_json(fit.chosen().direct);
  json["bands"] = bands_json(fit);
  json["means"] = {{"note", mean_caveat},
                   {"harmonic", levels_json(fit.harmonic)},
                   {"arithmetic", levels_json(fit.arithmetic)}};
  json.update(data_json(fit.data));
  json["cells"] = cells_json(fit.grid);
  add_provenance(json);
  return json;
}

}  // namespace apps
