#include "libstudy/analysis/ptpe/estimates_json.hpp"

#include <fmt/core.h>
#include <cmath>

#include "libstudy/analysis/json_parts.hpp"
#include "stats/base/json.hpp"

namespace study {

namespace {

using stats::CurveSpread;
using stats::Result;

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

/// Adds standard errors and intervals; null if `spread` is refused. Spread must have the members a_ci, b_ci,
/// a_se and b_se.
template <class Spread>
void add_spread(Json& json, const Result<Spread>& spread) {
  json["a_se"] = spread ? Json(spread->a_se) : Json();
  json["b_se"] = spread ? Json(spread->b_se) : Json();
  json["a_ci"] = spread ? json_interval(spread->a_ci) : Json();
  json["b_ci"] = spread ? json_interval(spread->b_ci) : Json();
}

void add_spread(Json& json, const Result<CurveSpread>& spread) {
  add_spread(json, spread ? Result<MainSpread>(
                                MainSpread{spread->a_ci, spread->b_ci, spread->a_se(), spread->b_se(), false})
                          : stats::Refusal{spread.reason()});
}

void add_curve(Json& json, const stats::Curve* curve) {
  json["a"] = curve ? Json(curve->a()) : Json();
  json["b"] = curve ? Json(curve->b) : Json();
}

Json estimator_entry(const char* code, const char* label, double level, bool main = false) {
  return {{"code", code}, {"label", label}, {"main", main}, {"level", level}};
}

Json ordinal_json(Json json, const stats::OrdinalPilotEstimate& estimate) {
  add_curve(json, estimate.fit ? &estimate.fit->curve : nullptr);
  add_spread(json, estimate.jackknife);
  json["reason"] = estimate.jackknife.reason();
  json["interval"] = "jackknife-t over participants";
  if (!estimate.fit) return json;
  json["k"] = estimate.fit->k;
  json["m"] = estimate.fit->m;
  json["q"] = estimate.fit->q;
  json["sd_participant"] = estimate.fit->sd_participant;
  json["thresholds"] = estimate.fit->thresholds;
  json["log_likelihood"] = estimate.fit->log_likelihood;
  json["link"] = "probit";
  return json;
}

}  // namespace

void add_estimate(Json& json, const MainEstimate& estimate) {
  json["converged"] = static_cast<bool>(estimate.fit);
  json["a"] = estimate.fit ? Json(estimate.fit->a) : Json();
  json["b"] = estimate.fit ? Json(estimate.fit->b) : Json();
  add_spread(json, estimate.spread);
}

Json direct_json(const stats::DirectEstimate& estimate) {
  const auto& reason = estimate.fit ? estimate.jackknife.reason() : estimate.fit.reason();
  Json json{{"status", reason.empty() ? "ok" : "failed"}, {"reason", reason}};
  add_curve(json, estimate.fit ? &estimate.fit->curve : nullptr);
  add_spread(json, estimate.jackknife);
  json["interval"] = "jackknife-t over participants";
  if (!estimate.fit) return json;
  json["k"] = estimate.fit->k;
  json["m"] = estimate.fit->m;
  json["q"] = estimate.fit->q;
  json["rss"] = estimate.fit->rss;
  json["n_observations"] = estimate.fit->n;
  json["out_of_reach"] = estimate.out_of_reach;
  json["far_above"] = estimate.far_above;
  Json bootstrap{{"method", "expanded percentile (Hesterberg 2015)"}};
  if (estimate.bootstrap) {
    add_spread(bootstrap, estimate.bootstrap);
    bootstrap["resamples_without_fit"] = estimate.bootstrap->failed;
  } else {
    bootstrap["reason"] = estimate.bootstrap.reason();
  }
  json["bootstrap"] = bootstrap;
  return json;
}

Json contour_estimate_json(const stats::PilotEstimate& estimate) {
  Json json{{"status", estimate.fit && estimate.spread ? "ok" : "failed"},
            {"reason", estimate.spread.reason()}};
  json["a"] = estimate.fit ? Json(estimate.fit->a) : Json();
  json["b"] = estimate.fit ? Json(estimate.fit->b) : Json();
  add_spread(json, estimate.spread);
  json["interval"] = "expanded percentile bootstrap over participants (Hesterberg 2015)";
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

Json estimators_json(const PilotFit& fit) {
  Json list = Json::array();
  for (const auto& [level, at] : fit.harmonic) {
    auto direct = estimator_entry("direct", "direct model of all ratings", level, level == fit.level);
    direct.update(direct_json(at.direct));
    list.push_back(direct);
    auto contour = estimator_entry("contour", "contour of means (the paper's)", level);
    contour.update(contour_estimate_json(at.contour));
    list.push_back(contour);
    list.push_back(ordinal_json(estimator_entry("ordinal", "ordinal mixed model", level), at.ordinal));
  }
  return list;
}

Json bands_json(const PilotFit& fit) {
  Json list = Json::array();
  if (fit.deltas.empty()) return list;
  for (const auto& [level, at] : fit.harmonic) {
    if (!at.direct.jackknife) continue;
    for (double delta = fit.deltas.front(); delta <= fit.deltas.back(); delta += 1) {
      const auto point = at.direct.jackknife->band(delta);
      list.push_back({{"level", level},
                      {"delta", delta},
                      {"mu", point.mu},
                      {"ci", json_interval(point.pointwise)},
                      {"simultaneous_ci", json_interval(point.simultaneous)},
                      {"solver_mu", at.band ? Json(at.band->curve.mu(delta)) : Json()},
                      {"solver_ci", at.band ? json_interval(at.band->band(delta).pointwise) : Json()}});
    }
  }
  return list;
}

Json form_json(const PilotFit& fit) {
  const auto& form = fit.chosen().direct.form;
  if (!form) return {{"refused", form.reason()}};
  Json curve = Json::array();
  for (double delta = fit.deltas.front(); delta <= fit.deltas.back(); delta += 1) {
    const auto point = form->curve.band(delta);
    curve.push_back({{"delta", delta},
                     {"mu", point.mu},
                     {"ci", json_interval(point.pointwise)},
                     {"simultaneous_ci", json_interval(point.simultaneous)}});
  }
  return {{"c", form->c},
          {"ci", form->ci},
          {"se", form->se},
          {"t", form->t},
          {"df", form->df},
          {"p", form->p},
          {"rejected", form->rejected()},
          {"level_of_test", stats::form_level},
          {"power", stats::form_power},
          {"detectable", form->detectable},
          {"delta_middle", form->curve.middle},
          {"delta_half_range", form->curve.half},
          {"text", stats::form_text(*form)},
          {"free_curve", curve}};
}

Json lack_of_fit_json(const stats::DirectEstimate& estimate) {
  if (!estimate.lack_of_fit) return {{"refused", estimate.lack_of_fit.reason()}};
  const auto& test = *estimate.lack_of_fit;
  const bool straight_fits = test.p >= 0.05;
  const std::string statistic = fmt::format("F({}, {}) = {:.2f}, p {} {:.3f}", test.df1, test.df2, test.f,
                                            test.p < 0.001 ? "<" : "=", std::max(test.p, 0.001));
  const std::string text =
      straight_fits
          ? std::string(statistic) +
                ": the scores do not depart from an even rise with the logarithm of the mean frame rate and "
                "with the deviation; the estimates allow for a departure all the same"
          : std::string(statistic) +
                ": the scores do not rise evenly with the logarithm of the mean frame rate and with the "
                "deviation, as where they level off towards an end of the scale; the estimates allow for "
                "that "
                "and stand, only those of the simpler straight form (m = q = 0) would be biased";
  Json json{{"m", test.m},     {"q", test.q}, {"f", test.f},  {"df1", test.df1},
            {"df2", test.df2}, {"p", test.p}, {"text", text}, {"straight_may_be_used", straight_fits}};
  Json straight{{"reason", estimate.straight_jackknife.reason()}};
  add_curve(straight, estimate.straight ? &estimate.straight->curve : nullptr);
  add_spread(straight, estimate.straight_jackknife);
  json["straight"] = straight;
  return json;
}

}  // namespace study
