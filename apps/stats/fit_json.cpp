#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/stats/pilot_fit.hpp"
#include "stats/base/file.hpp"
#include "stats/gsl_errors.hpp"

namespace apps {

namespace {

using Json = nlohmann::ordered_json;
using stats::PilotEstimate;

constexpr const char* estimator =
    "contour of mean scores per setting, bilinear interpolation, sampled at every whole frame/s of the "
    "standard "
    "deviation; least squares of mu = a exp(b delta)";
constexpr const char* interval_method =
    "expanded percentile bootstrap (Hesterberg 2015), whole participants resampled";
constexpr const char* mean_caveat =
    "The paper does not say which mean its 23.68 and 0.02 refer to; settings drawn with a given arithmetic "
    "mean run "
    "at a lower harmonic one. The solver's tau uses the harmonic mean.";

Json contour_json(const stats::Contour& contour) {
  Json points = Json::array();
  for (const auto& point : contour.points) points.push_back({point.delta, point.mu});
  return {{"lines", contour.lines},
          {"crossed", contour.crossed},
          {"crossed_more_than_once", contour.crossed_twice},
          {"above_grid", contour.above_grid},
          {"below_grid", contour.below_grid},
          {"on_node", contour.on_node},
          {"points_delta_mu", points}};
}

/// a, b and their spread; null where undefined.
void add_estimate(Json& json, const PilotEstimate& estimate) {
  json["converged"] = static_cast<bool>(estimate.fit);
  json["a"] = estimate.fit ? Json(estimate.fit->a) : Json();
  json["b"] = estimate.fit ? Json(estimate.fit->b) : Json();
  json["a_se"] = estimate.spread ? Json(estimate.spread->a_se) : Json();
  json["b_se"] = estimate.spread ? Json(estimate.spread->b_se) : Json();
  json["a_ci"] = estimate.spread ? Json(estimate.spread->a_ci) : Json();
  json["b_ci"] = estimate.spread ? Json(estimate.spread->b_ci) : Json();
}

Json estimate_json(const PilotEstimate& estimate) {
  Json json{{"status", estimate.fit && estimate.spread ? "ok" : "failed"},
            {"reason", estimate.spread.reason()}};
  add_estimate(json, estimate);
  if (estimate.fit) {
    Json fit{{"rss", estimate.fit->rss}, {"df", estimate.fit->df()}, {"points", estimate.fit->n}};
    if (estimate.fit->covariance) {
      fit["a_se"] = std::sqrt(estimate.fit->covariance->aa);
      fit["b_se"] = std::sqrt(estimate.fit->covariance->bb);
      fit["note"] = "of the curve through the contour's points alone; says nothing of the participants";
    }
    json["least_squares"] = fit;
  }
  if (estimate.spread) json["resamples_without_fit"] = estimate.spread->failed;
  json["contour"] = contour_json(estimate.contour);
  return json;
}

Json levels_json(const std::map<double, PilotEstimate>& estimates) {
  Json list = Json::array();
  for (const auto& [level, estimate] : estimates) {
    Json json{{"level", level}};
    json.update(estimate_json(estimate));
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
  add_estimate(json, {});
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
  json["interval"] = {{"method", interval_method},
                      {"confidence", fit.bootstrap.confidence},
                      {"resamples", fit.bootstrap.resamples},
                      {"seed", fit.bootstrap.seed}};
  json["level5"] = estimate_json(fit.harmonic.at(5.0));
  json["means"] = {{"note", mean_caveat},
                   {"harmonic", levels_json(fit.harmonic)},
                   {"arithmetic", levels_json(fit.arithmetic)}};
  json.update(data_json(fit.data));
  json["cells"] = cells_json(fit.grid);
  add_provenance(json);
  return json;
}

}  // namespace apps
