#include "libstudy/power/pilot_power.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "libstudy/base/random.hpp"
#include "libstudy/power/answers.hpp"
#include "stats/ptpe/direct_fit.hpp"

namespace study {

namespace {

/// Fits one simulated pilot. `level`: score at which the curve is fitted.
PilotOutcome estimate(std::span<const stats::PilotRating> ratings, double level,
                      const PowerRequest& request) {
  PilotOutcome out;
  const auto observations = stats::PilotTable(ratings).observations(stats::PilotMean::Harmonic);
  stats::BootstrapOptions options;
  options.resamples = 0;
  options.confidence = request.plan.plan.confidence;
  const auto direct = stats::estimate_direct(observations, level, options);
  out.fitted = static_cast<bool>(direct.fit);
  out.interval = static_cast<bool>(direct.jackknife);
  if (!out.interval) return out;
  out.a = {direct.jackknife->curve.a(), direct.jackknife->a_se(), direct.jackknife->a_ci};
  out.b = {direct.jackknife->curve.b, direct.jackknife->b_se(), direct.jackknife->b_ci};
  return out;
}

/// Standard deviation of the values (divisor n - 1) and its Monte-Carlo standard error.
Estimated sd_of(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  const double mean = mean_of(values).value;
  double m2 = 0, m4 = 0;
  for (const double x : values) {
    m2 += std::pow(x - mean, 2) / n;
    m4 += std::pow(x - mean, 4) / n;
  }
  const double sd = std::sqrt(m2 * n / (n - 1));
  // Standard error of the standard deviation by the delta method, from the standard error of the variance.
  return {sd, sd > 0 ? std::sqrt(std::max(0.0, m4 - m2 * m2) / n) / (2 * sd) : 0};
}

using Coefficient = std::function<const PilotEstimate&(const PilotOutcome&)>;

std::optional<CoefficientPoint> describe(const std::vector<PilotOutcome>& pilots,
                                         const Coefficient& coefficient, double truth,
                                         std::optional<double> precision, const PowerRequest& request) {
  std::vector<double> values, errors, widths;
  std::int64_t held = 0, reached = 0;
  for (const auto& pilot : pilots) {
    if (!pilot.interval) continue;
    const auto& one = coefficient(pilot);
    values.push_back(one.value);
    errors.push_back(one.se);
    widths.push_back(one.half_width());
    held += one.ci[0] <= truth && truth <= one.ci[1] ? 1 : 0;
    reached += precision && widths.back() <= *precision ? 1 : 0;
  }
  if (values.size() < 2) return {};
  CoefficientPoint out;
  out.mean = mean_of(values);
  out.sd = sd_of(values);
  out.se = quantile_of(errors, 0.5);
  out.half_width = quantile_of(widths, 0.5);
  out.half_width_wished = quantile_of(widths, request.power);
  out.coverage = share_of(held, static_cast<int>(values.size()));
  if (precision) out.reached = share_of(reached, static_cast<int>(pilots.size()));
  return out;
}

PilotPoint describe(const std::vector<PilotOutcome>& pilots, const PowerRequest& request) {
  const auto count = [&](auto has) { return std::count_if(pilots.begin(), pilots.end(), has); };
  const int studies = static_cast<int>(pilots.size());
  return {share_of(count([](const PilotOutcome& one) { return one.fitted; }), studies),
          share_of(count([](const PilotOutcome& one) { return one.interval; }), studies),
          describe(
              pilots, [](const PilotOutcome& one) -> const PilotEstimate& { return one.a; },
              request.observer.a, request.precision_a, request),
          describe(
              pilots, [](const PilotOutcome& one) -> const PilotEstimate& { return one.b; },
              request.observer.b, request.precision_b, request)};
}

/// The smallest n such that `reached` is true at this n and at every larger requested n.
std::optional<int> lasting(const PowerRequest& request, const std::vector<PilotPoint>& curve,
                           const std::function<bool(const PilotPoint&)>& reached) {
  std::optional<int> out;
  for (std::size_t i = curve.size(); i-- > 0 && reached(curve[i]);) out = request.n[i];
  return out;
}

void find_n(PilotPower& power, const PowerRequest& request) {
  const auto often = [&](const std::optional<CoefficientPoint>& one) {
    return one && one->reached && one->reached->value >= request.power;
  };
  const auto half = [&](const std::optional<CoefficientPoint>& one) {
    return one && one->reached && one->reached->value >= 0.5;
  };
  const auto& curve = power.curve;
  power.n_for_a = lasting(request, curve, [&](const PilotPoint& at) { return often(at.a); });
  power.n_for_b = lasting(request, curve, [&](const PilotPoint& at) { return often(at.b); });
  power.n_for_a_median = lasting(request, curve, [&](const PilotPoint& at) { return half(at.a); });
  power.n_for_b_median = lasting(request, curve, [&](const PilotPoint& at) { return half(at.b); });
  if (power.n_for_a && power.n_for_b) power.n_for_both = std::max(*power.n_for_a, *power.n_for_b);
}

}  // namespace

PilotOutcomes simulate_pilots(const PowerRequest& request, StudyRange studies) {
  const auto question = rated_question(request);
  const double level = rated_level(request);
  const auto settings = realised_settings(request.protocol);
  const std::uint64_t own = random_key(request.protocol.sha256 + "\npower " + std::to_string(request.seed));
  PilotOutcomes out(request.n.size(), std::vector<PilotOutcome>(static_cast<std::size_t>(studies.count)));
  for_each_study(studies, "pilots", [&](int study) {
    const std::uint64_t key = counter_random(own, static_cast<std::uint64_t>(study));
    const auto trials = planned_trials(request.protocol, key, request.n.back());
    const auto ratings = answer_pilot(trials, settings, request.observer,
                                      {question.scale_min, question.scale_max, level}, key);
    for (std::size_t i = 0; i < request.n.size(); ++i) {
      const auto end = std::partition_point(
          ratings.begin(), ratings.end(),
          [&](const stats::PilotRating& rating) { return rating.participant < request.n[i]; });
      out[i][static_cast<std::size_t>(study - studies.first)] =
          estimate({ratings.begin(), end}, level, request);
    }
  });
  return out;
}

PilotPower pilot_power(const PowerRequest& request, const PilotOutcomes& pilots) {
  PilotPower out;
  for (const auto& of_n : pilots) out.curve.push_back(describe(of_n, request));
  find_n(out, request);
  return out;
}

PilotPower simulate_pilot_power(const PowerRequest& request) {
  return pilot_power(request, simulate_pilots(request, {0, request.studies}));
}

}  // namespace study
