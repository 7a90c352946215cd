#include "stats/ptpe/pilot_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "stats/inference/t_test.hpp"

namespace stats {

namespace {

/// A person's mean scores: by nominal standard deviation of the frame rate, then by nominal mean.
using Scores = std::map<double, std::map<double, double>>;

std::vector<Scores> scores_of(const PilotTable& table) {
  std::vector<Scores> all(static_cast<std::size_t>(table.participants()));
  for (const auto& o : table.observations(PilotMean::Harmonic))
    all[static_cast<std::size_t>(o.participant)][o.nominal_delta][o.nominal_mu] = o.score;
  return all;
}

std::vector<double> rates_of(const std::vector<Scores>& people) {
  std::vector<double> rates;
  for (const auto& scores : people)
    for (const auto& [delta, row] : scores)
      for (const auto& [mu, score] : row) rates.push_back(mu);
  std::sort(rates.begin(), rates.end());
  rates.erase(std::unique(rates.begin(), rates.end()), rates.end());
  return rates;
}

/// A person's slope: points of the scale for each doubling of the frame rate. Empty if no standard deviation
/// was shown at two mean frame rates.
std::optional<double> slope_of(const Scores& scores) {
  double xy = 0, xx = 0;
  for (const auto& [delta, row] : scores) {
    double x_mean = 0, y_mean = 0;
    for (const auto& [mu, score] : row) {
      x_mean += std::log2(mu) / static_cast<double>(row.size());
      y_mean += score / static_cast<double>(row.size());
    }
    for (const auto& [mu, score] : row) {
      const double x = std::log2(mu) - x_mean;
      xy += x * (score - y_mean);
      xx += x * x;
    }
  }
  return xx > 0 ? std::optional(xy / xx) : std::nullopt;
}

/// Mean score at the mean frame rate `high` minus that at `low`, over the standard deviations at which both
/// were shown.
std::optional<double> rise_between(const Scores& scores, double low, double high) {
  double sum = 0;
  int n = 0;
  for (const auto& [delta, row] : scores) {
    const auto from = row.find(low), to = row.find(high);
    if (from == row.end() || to == row.end()) continue;
    sum += to->second - from->second;
    ++n;
  }
  return n > 0 ? std::optional(sum / n) : std::nullopt;
}

template <class Measure>
std::vector<double> over_people(const std::vector<Scores>& people, const Measure& measure) {
  std::vector<double> values;
  for (const auto& scores : people)
    if (const auto value = measure(scores)) values.push_back(*value);
  return values;
}

/// One-sided p of a t test against a mean of zero. If all values are equal, there is no t; p is then 0 or 1
/// by their sign. p is 1 for fewer than two values.
double one_sided_p(const std::vector<double>& values, Alternative alternative) {
  const auto test = t_test_one(values, {.alternative = alternative, .effect_intervals = false});
  if (test) return test->p;
  if (values.size() < 2) return 1;
  return (alternative == Alternative::Greater ? values[0] > 0 : values[0] < 0) ? 0 : 1;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

void doubt_rise(std::vector<PilotDoubt>& doubts, const std::vector<Scores>& people) {
  const auto slopes = over_people(people, slope_of);
  if (slopes.size() < 2) return;
  const double p = one_sided_p(slopes, Alternative::Greater);
  if (p < rise_level) return;
  doubts.push_back(
      {"no_rise", fmt::format("the scores do not rise with the mean frame rate: {:+.2f} points for each "
                              "doubling (one-sided p = {:.3f}, limit {:g})",
                              mean_of(slopes), p, rise_level)});
}

void doubt_fall(std::vector<PilotDoubt>& doubts, const std::vector<Scores>& people) {
  const auto rates = rates_of(people);
  const double pairs = 0.5 * static_cast<double>(rates.size()) * static_cast<double>(rates.size() - 1);
  double least = 1, low = 0, high = 0, change = 0;
  for (std::size_t i = 0; i < rates.size(); ++i) {
    for (std::size_t j = i + 1; j < rates.size(); ++j) {
      const auto rises =
          over_people(people, [&](const Scores& scores) { return rise_between(scores, rates[i], rates[j]); });
      if (rises.empty()) continue;
      const double p = one_sided_p(rises, Alternative::Less) * pairs;
      if (!(p < least)) continue;
      least = p;
      low = rates[i];
      high = rates[j];
      change = mean_of(rises);
    }
  }
  if (least >= fall_level) return;
  doubts.push_back(
      {"falls",
       fmt::format("the scores fall where the mean frame rate rises: {:+.2f} points from {:g} to {:g} "
                   "frames/s (one-sided p {} {:.4f} after Bonferroni, limit {:g})",
                   change, low, high, least < 1e-4 ? "<" : "=", std::max(least, 1e-4), fall_level)});
}

/// An estimator's intervals of a (index 0) and b (index 1) of the threshold curve a exp(b delta).
struct Intervals {
  const char* name;
  std::array<std::array<double, 2>, 2> of;
};

void doubt_agreement(std::vector<PilotDoubt>& doubts, const std::vector<Intervals>& estimators) {
  for (std::size_t i = 0; i < estimators.size(); ++i) {
    for (std::size_t j = i + 1; j < estimators.size(); ++j) {
      for (std::size_t k = 0; k < 2; ++k) {
        const auto &x = estimators[i].of[k], &y = estimators[j].of[k];
        if (x[0] <= y[1] && y[0] <= x[1]) continue;
        doubts.push_back(
            {"estimators_disagree",
             fmt::format(
                 "the estimators disagree about {}: [{:.4g}, {:.4g}] by the {} one, [{:.4g}, {:.4g}] by "
                 "the {} one",
                 k == 0 ? "a" : "b", x[0], x[1], estimators[i].name, y[0], y[1], estimators[j].name)});
        return;
      }
    }
  }
}

}  // namespace

std::string form_text(const FormTest& form) {
  const std::string test =
      fmt::format("c = {:+.3f} [{:.3f}, {:.3f}], t({}) = {:.2f}, p {} {:.3f}", form.c, form.ci[0], form.ci[1],
                  form.df, form.t, form.p < 0.001 ? "<" : "=", std::max(form.p, 0.001));
  const std::string reach = fmt::format(
      "this test finds a bend of {:.3f} with a power of {:.2f}, that is a curve {:.0f} % off an "
      "exponential in the middle and at both ends",
      form.detectable, form_power, 50 * form.detectable);
  if (!form.rejected()) return test + ": the ratings do not contradict an exponential; " + reach;
  return fmt::format(
      "{}: the threshold is no exponential of the standard deviation, it {}; an exponential is "
      "about {:.0f} % off in the middle and at both ends; {}",
      test, form.c < 0 ? "levels off" : "bends upwards more", 50 * std::abs(form.c), reach);
}

std::optional<PilotDoubt> form_doubt(const DirectEstimate& direct) {
  if (!direct.form || !direct.form->rejected()) return std::nullopt;
  return PilotDoubt{form_rejected, "form of the curve: " + form_text(*direct.form)};
}

std::optional<PilotDoubt> band_doubt(const Curve& curve, const Result<CurveSpread>& band,
                                     std::span<const double> deltas) {
  if (!band) return PilotDoubt{"no_band", "the curve has no band: " + band.reason()};
  for (const double delta : deltas) {
    const auto [low, high] = band->band(delta).pointwise;
    const double mu = curve.mu(delta);
    if (low <= mu && mu <= high) continue;
    return PilotDoubt{"curve_outside_band",
                      fmt::format("at a standard deviation of {:g} the direct curve, {:.2f} frames/s, leaves "
                                  "the band [{:.2f}, {:.2f}]",
                                  delta, mu, low, high)};
  }
  return std::nullopt;
}

std::vector<PilotDoubt> pilot_doubts(const PilotTable& table, const DirectEstimate& direct,
                                     const PilotEstimate& contour, const OrdinalPilotEstimate& ordinal) {
  std::vector<PilotDoubt> doubts;
  const auto people = scores_of(table);
  doubt_rise(doubts, people);
  doubt_fall(doubts, people);
  if (direct.jackknife) {
    const auto& spread = *direct.jackknife;
    if (spread.a_se() <= 1e-9 * spread.curve.a() || spread.b_se() <= 1e-12)
      doubts.push_back(
          {"no_spread", "the participants do not differ: an interval over them would have no width"});
    if (direct.in_reach < least_deltas_in_reach)
      doubts.push_back(
          {"few_deltas", fmt::format("the curve runs through the frame rates shown at {} of the standard "
                                     "deviations, and at least {} are needed",
                                     direct.in_reach, least_deltas_in_reach)});
    if (spread.b_ci[1] < 0)
      doubts.push_back({"b_below_zero",
                        fmt::format("b is below zero, [{:.4f}, {:.4f}] by the direct estimate: fluctuation "
                                    "would be liked",
                                    spread.b_ci[0], spread.b_ci[1])});
  }
  std::vector<Intervals> estimators;
  if (direct.jackknife) estimators.push_back({"direct", {direct.jackknife->a_ci, direct.jackknife->b_ci}});
  if (contour.spread) estimators.push_back({"contour", {contour.spread->a_ci, contour.spread->b_ci}});
  if (ordinal.jackknife)
    estimators.push_back({"ordinal", {ordinal.jackknife->a_ci, ordinal.jackknife->b_ci}});
  doubt_agreement(doubts, estimators);
  return doubts;
}

}  // namespace stats
