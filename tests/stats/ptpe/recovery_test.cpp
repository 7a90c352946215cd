/// Which estimate finds the population mean's contour: simulated pilots over a grid of truths, among them
/// surfaces outside every estimator's family. The table printed stands in docs/statistics.md.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "stats/ptpe/direct_fit.hpp"
#include "stats/ptpe/ordinal_pilot.hpp"
#include "stats/ptpe/pilot_doubts.hpp"
#include "tests/stats/ptpe/surfaces.hpp"

namespace {

using surfaces::Population;
using surfaces::Truth;

constexpr std::array names{"direct", "contour", "ordinal"};
constexpr double widest = 0.35;  // as vip-stats fit-ptpe --max-width

/// What one estimator made of one pilot.
struct One {
  bool given = false;  ///< an interval and no doubt, so that a file would be written
  double a = 0, b = 0, curve_error = 0;
  bool holds_a = false, holds_b = false;
};

using All = std::array<One, names.size()>;

bool holds(const std::array<double, 2>& interval, double value) {
  return interval[0] <= value && value <= interval[1];
}

One judged(const stats::Curve& curve, const std::array<double, 2>& a_ci, const std::array<double, 2>& b_ci,
           const Truth& truth) {
  One out{true, curve.a(), curve.b, 0, holds(a_ci, truth.a), holds(b_ci, truth.b)};
  for (std::size_t i = 0; i < truth.delta.size(); ++i)
    out.curve_error +=
        std::pow(curve.mu(truth.delta[i]) / truth.mu[i] - 1, 2) / static_cast<double>(truth.delta.size());
  out.curve_error = std::sqrt(out.curve_error);
  return out;
}

All estimate(const Population& population, const Truth& truth, int participants, std::uint64_t seed) {
  const auto ratings = surfaces::pilot(population, participants, seed);
  const stats::PilotTable table(ratings);
  const stats::BootstrapOptions options{200, seed, 0.95};
  const auto direct =
      stats::estimate_direct(table.observations(stats::PilotMean::Harmonic), 4, {0, seed, 0.95});
  const auto contour = stats::estimate_pilot(table, stats::PilotMean::Harmonic, 4, options);
  const auto ordinal = stats::estimate_ordinal_pilot(ratings, stats::PilotMean::Harmonic, 4, 0.95);
  All out;
  const bool doubted = !stats::pilot_doubts(table, direct, contour, ordinal).empty();
  const auto add = [&](One& one, const auto& fit, const auto& spread) {
    if (doubted || !spread || spread->largest_relative_half_width(surfaces::deviations) > widest) return;
    one = judged(fit->curve, spread->a_ci, spread->b_ci, truth);
  };
  add(out[0], direct.fit, direct.jackknife);
  if (!doubted && contour.spread)
    out[1] =
        judged({std::log(contour.fit->a), contour.fit->b}, contour.spread->a_ci, contour.spread->b_ci, truth);
  add(out[2], ordinal.fit, ordinal.jackknife);
  return out;
}

struct Row {
  double refused = 0, bias_a = 0, error_a = 0, bias_b = 0, error_b = 0, curve_error = 0, holds_a = 0,
         holds_b = 0;
  int given = 0;
};

Row summary(const std::vector<All>& all, std::size_t estimator, const Truth& truth) {
  Row row;
  for (const auto& pilot : all) {
    const One& one = pilot[estimator];
    if (!one.given) continue;
    ++row.given;
    row.bias_a += one.a - truth.a;
    row.error_a += std::pow(one.a - truth.a, 2);
    row.bias_b += one.b - truth.b;
    row.error_b += std::pow(one.b - truth.b, 2);
    row.curve_error += one.curve_error;
    row.holds_a += one.holds_a;
    row.holds_b += one.holds_b;
  }
  row.refused = 1 - row.given / static_cast<double>(all.size());
  for (double* sum :
       {&row.bias_a, &row.error_a, &row.bias_b, &row.error_b, &row.curve_error, &row.holds_a, &row.holds_b})
    *sum /= std::max(1, row.given);
  row.error_a = std::sqrt(row.error_a);
  row.error_b = std::sqrt(row.error_b);
  return row;
}

void recover(const Population& population, int participants, int pilots) {
  const Truth truth = surfaces::truth_of(population);
  std::vector<All> all(static_cast<std::size_t>(pilots));
#pragma omp parallel for schedule(dynamic)
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = estimate(population, truth, participants, i + 1);
  for (std::size_t e = 0; e < names.size(); ++e) {
    const Row row = summary(all, e, truth);
    std::printf(
        "| %s | %.2f | %.4f | %d | %s | %.2f | %+.2f | %.2f | %+.4f | %.4f | %.1f %% | %.2f | %.2f |\n",
        population.name.c_str(), truth.a, truth.b, participants, names[e], row.refused, row.bias_a,
        row.error_a, row.bias_b, row.error_b, 100 * row.curve_error, row.holds_a, row.holds_b);
  }
  std::fflush(stdout);
}

TEST(EstimatorRecoverySlow, Grid) {
  const char* few = std::getenv("PILOTS");
  const int pilots = few ? std::atoi(few) : 40;
  for (const auto& population : surfaces::strange()) recover(population, 16, pilots);
  for (const double a : {12.0, 15.0, 18.0, 24.0, 30.0, 36.0})
    for (const double b : {-0.01, 0.01, 0.03, 0.05}) recover(surfaces::parametric(a, b), 16, pilots);
}

}  // namespace
