/// How well each estimate recovers the contour (the curve of frame rates at which a population's mean score
/// is 4): simulated pilots over a grid of truths, including populations outside every estimator's model.
/// docs/statistics.md has the printed table.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "stats/ptpe/direct_fit.hpp"
#include "stats/ptpe/ordinal_pilot.hpp"
#include "stats/ptpe/pilot_doubts.hpp"
#include "stats/ptpe/solver_interval.hpp"
#include "tests/stats/ptpe/surfaces.hpp"

namespace {

using surfaces::Population;
using surfaces::Truth;

constexpr std::array names{"solver", "direct", "contour",
                           "ordinal"};  // solver: the direct estimate, with intervals that span
                                        // those of direct and contour
constexpr double widest = 0.35;         // the default of vip-stats fit-ptpe --max-width

/// An estimator's result for one pilot.
struct One {
  bool given = false;  ///< it has an interval and raises no doubts, so its file is written
  double a = 0, b = 0;
  bool holds_a = false, holds_b = false;
};

using All = std::array<One, names.size()>;

bool holds(const std::array<double, 2>& interval, double value) {
  return interval[0] <= value && value <= interval[1];
}

One judged(const stats::Curve& curve, const std::array<double, 2>& a_ci, const std::array<double, 2>& b_ci,
           const Truth& truth) {
  return {true, curve.a(), curve.b, holds(a_ci, truth.a), holds(b_ci, truth.b)};
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
  const auto in_reach = direct.in_reach_of(surfaces::deviations);
  const auto usable = [&](const auto& spread) {
    return !doubted && spread && spread->largest_relative_half_width(in_reach) <= widest;
  };
  if (usable(direct.jackknife)) {
    const auto open = stats::solver_interval(*direct.jackknife, contour.spread);
    out[0] = judged(direct.fit->curve, open.a_ci, open.b_ci, truth);
    out[1] = judged(direct.fit->curve, direct.jackknife->a_ci, direct.jackknife->b_ci, truth);
  }
  if (!doubted && contour.spread)
    out[2] =
        judged({std::log(contour.fit->a), contour.fit->b}, contour.spread->a_ci, contour.spread->b_ci, truth);
  if (usable(ordinal.jackknife))
    out[3] = judged(ordinal.fit->curve, ordinal.jackknife->a_ci, ordinal.jackknife->b_ci, truth);
  return out;
}

struct Row {
  double refused = 0, bias_a = 0, error_a = 0, bias_b = 0, error_b = 0, holds_a = 0, holds_b = 0;
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
    row.holds_a += one.holds_a;
    row.holds_b += one.holds_b;
  }
  row.refused = 1 - row.given / static_cast<double>(all.size());
  for (double* sum : {&row.bias_a, &row.error_a, &row.bias_b, &row.error_b, &row.holds_a, &row.holds_b})
    *sum /= std::max(1, row.given);
  row.error_a = std::sqrt(row.error_a);
  row.error_b = std::sqrt(row.error_b);
  return row;
}

struct Kind {
  Population population;
  int participants;
  bool near = false;  ///< realistic for a lab, so few pilots may be refused
};

void recover(const Kind& kind, int pilots) {
  const auto& population = kind.population;
  const Truth truth = surfaces::truth_of(population);
  std::vector<All> all(static_cast<std::size_t>(pilots));
#pragma omp parallel for schedule(dynamic)
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = estimate(population, truth, kind.participants, i + 1);
  std::printf("| %s, %d | %.1f, %.3f", population.name.c_str(), kind.participants, truth.a, truth.b);
  for (std::size_t e = 0; e < names.size(); ++e) {
    const Row row = summary(all, e, truth);
    const bool few = row.given < 20;
    if (e != 1) std::printf(" | %.2f", row.refused);  // the direct estimate has the solver's share
    if (e != 1 && few) std::printf(" | ");
    if (e != 1 && !few)
      std::printf(" | %+.2f, %+.4f (%.2f, %.4f)", row.bias_a, row.bias_b, row.error_a, row.error_b);
    few ? std::printf(" | ") : std::printf(" | %.2f, %.2f", row.holds_a, row.holds_b);
    if (e > 0 || few) continue;
    // Bounds for the solver's estimate, wider by two and a half Monte-Carlo standard errors.
    const double error = 2.5 * std::sqrt(0.08 * 0.92 / row.given);
    EXPECT_GE(row.holds_a, 0.92 - error) << population.name << ", " << kind.participants;
    EXPECT_GE(row.holds_b, 0.92 - error) << population.name << ", " << kind.participants;
    if (kind.near) {
      EXPECT_LE(row.refused, 0.05 + 2.5 * std::sqrt(0.05 * 0.95 / pilots)) << population.name;
    }
  }
  std::printf(" |\n");
  std::fflush(stdout);
}

TEST(EstimatorRecoverySlow, Grid) {
  constexpr int pilots = 500;
  std::printf(
      "| truth, people | a, b | direct: refused | bias (error) of a, b | spanned interval holds a, b | its "
      "own "
      "holds | contour: refused | bias (error) | holds | ordinal: refused | bias (error) | holds |\n");
  std::vector<Kind> kinds;
  for (const double a : {12.0, 18.0, 24.0, 30.0, 36.0}) {
    for (const double b : {-0.01, 0.01, 0.03, 0.05})
      kinds.push_back({surfaces::parametric(a, b), 16, a >= 18 && a <= 30 && b > 0 && b < 0.04});
  }
  for (const int people : {16, 40}) kinds.push_back({surfaces::parametric(15, 0.015), people});
  kinds.push_back({surfaces::parametric(18, 0.01), 40, true});
  for (const int people : {6, 40}) {
    for (const double a : {18.0, 24.0, 30.0})
      kinds.push_back({surfaces::parametric(a, 0.02), people, people > 6});
  }
  for (const auto& population : surfaces::strange()) kinds.push_back({population, 16, true});
  for (const auto& kind : kinds) recover(kind, pilots);
}

}  // namespace
