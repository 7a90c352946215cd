/// How often the test of the threshold curve's form rejects exponentials and finds other curves, for how many
/// pilots a file for the solver is written, and the coverage of its bands: simulated pilots of the paper's 21
/// settings. docs/statistics.md has the printed tables. VIP_PILOTS sets the number of pilots.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "stats/ptpe/direct_fit.hpp"
#include "stats/ptpe/ordinal_pilot.hpp"
#include "stats/ptpe/pilot_doubts.hpp"
#include "stats/ptpe/scale_end_fit.hpp"
#include "tests/stats/ptpe/surfaces.hpp"

namespace {

using surfaces::Population;

std::size_t pilots() {
  const char* given = std::getenv("VIP_PILOTS");
  return given ? std::strtoul(given, nullptr, 10) : 500;
}

double share(const std::vector<char>& all) {
  return static_cast<double>(std::count(all.begin(), all.end(), 1)) / static_cast<double>(all.size());
}

/// Three Monte-Carlo standard errors, by which a share may miss its bound.
double slack(double share, std::size_t n) {
  return 3 * std::sqrt(share * (1 - share) / static_cast<double>(n));
}

struct Sizes {
  double rejected = 0, written = 0, written_before = 0;
};

/// Shares of pilots. rejected: by the test of the form. written: all rules allow a file. written_before: all
/// rules but the test of the form allow it.
Sizes sizes_of(const Population& population, int people) {
  std::vector<char> rejected(pilots()), written(pilots()), before(pilots());
#pragma omp parallel for schedule(dynamic)
  for (std::size_t i = 0; i < rejected.size(); ++i) {
    const auto ratings = surfaces::pilot(population, people, i + 1);
    const stats::PilotTable table(ratings);
    const auto direct = stats::estimate_direct(table.observations(stats::PilotMean::Harmonic), 4, {0});
    const auto contour = stats::estimate_pilot(table, stats::PilotMean::Harmonic, 4, {200, i + 1, 0.95});
    const auto ordinal = stats::estimate_ordinal_pilot(ratings, stats::PilotMean::Harmonic, 4, 0.95);
    rejected[i] = direct.form && direct.form->rejected();
    before[i] =
        direct.jackknife && stats::pilot_doubts(table, direct, contour, ordinal).empty() &&
        direct.jackknife->largest_relative_half_width(direct.in_reach_of(surfaces::deviations)) <= 0.35;
    written[i] = before[i] && !rejected[i];
  }
  return {share(rejected), share(written), share(before)};
}

TEST(FormRecoverySlow, SizePowerAndFiles) {
  std::vector<Population> exponentials, others;
  for (const auto& [a, b] : {std::pair{23.68, 0.02}, {18.0, 0.02}, {20.0, 0.03}, {28.0, 0.01}, {30.0, 0.02}})
    exponentials.push_back(surfaces::with_threshold(
        std::to_string(a).substr(0, 5) + " exp(" + std::to_string(b).substr(0, 4) + " delta)",
        [a = a, b = b](double delta) { return surfaces::exponential(a, b, delta); }));
  others.push_back(surfaces::with_threshold("saturating", surfaces::saturating));
  others.push_back(surfaces::with_threshold("hinged", surfaces::hinged));
  others.push_back(surfaces::with_threshold("linear", surfaces::linear));
  std::printf("| threshold | people | rejected | files without the test | files |\n");
  for (const auto* list : {&exponentials, &others}) {
    for (const auto& population : *list) {
      for (const int people : {12, 16, 24}) {
        const auto found = sizes_of(population, people);
        std::printf("| %s | %d | %.3f | %.2f | %.2f |\n", population.name.c_str(), people, found.rejected,
                    found.written_before, found.written);
        std::fflush(stdout);
        if (list == &exponentials) {
          EXPECT_LE(found.rejected, 0.06 + slack(0.06, pilots())) << population.name << people;
        } else if (population.name != "linear") {
          EXPECT_GE(found.rejected, people < 16 ? 0.75 : 0.9) << population.name << people;
          EXPECT_LE(found.written, people < 16 ? 0.25 : 0.1) << population.name << people;
        }
      }
    }
  }
}

using Held = std::array<bool, 5>;  // whether a band holds the true curve, at each of surfaces::deviations

/// For one pilot: which bands hold the true curve.
struct Bands {
  bool given = false;  ///< the rules of the curve allow a file: form, reach, width and band
  Held direct{}, solver{};
};

bool holds(const stats::CurveSpread& curve, double delta, double mu) {
  const auto band = curve.band(delta).pointwise;
  return band[0] <= mu && mu <= band[1];
}

Bands bands_of(const Population& population, const std::array<double, 5>& truth, std::uint64_t seed) {
  const stats::PilotTable table(surfaces::pilot(population, 16, seed));
  const auto observations = table.observations(stats::PilotMean::Harmonic);
  const auto direct = stats::estimate_direct(observations, 4, {0});
  Bands out;
  if (!direct.jackknife || direct.in_reach < stats::least_deltas_in_reach) return out;
  if (!direct.form || direct.form->rejected()) return out;
  if (direct.jackknife->largest_relative_half_width(direct.in_reach_of(surfaces::deviations)) > 0.35)
    return out;
  const auto solver = stats::scale_end_curve(observations, direct, 4, {1, 7});
  if (stats::band_doubt(direct.fit->curve, solver, surfaces::deviations)) return out;
  out.given = true;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    out.direct[i] = holds(*direct.jackknife, surfaces::deviations[i], truth[i]);
    out.solver[i] = holds(*solver, surfaces::deviations[i], truth[i]);
  }
  return out;
}

/// Prints the shares at each deviation.
void print_shares(const std::vector<Bands>& all, Held Bands::*held) {
  std::printf(" |");
  for (std::size_t i = 0; i < surfaces::deviations.size(); ++i) {
    double n = 0, sum = 0;
    for (const Bands& one : all) {
      if (!one.given) continue;
      n += 1;
      sum += (one.*held)[i];
    }
    std::printf(" %.3f", sum / n);
    if (held != &Bands::solver) continue;
    const double miss = slack(0.95, static_cast<std::size_t>(n));
    EXPECT_GE(sum / n, 0.94 - miss) << surfaces::deviations[i];
    EXPECT_LE(sum / n, 0.96 + miss) << surfaces::deviations[i];
  }
}

TEST(FormRecoverySlow, Bands) {
  std::printf("| observer | a, b | refused | direct, at delta 0, 5, 10, 15, 20 | solver's file |\n");
  for (const auto& observer : {surfaces::parametric, surfaces::logarithmic}) {
    for (const double a : {18.0, 24.0, 30.0}) {
      for (const double b : {0.01, 0.02, 0.03}) {
        const auto population = observer(a, b);
        std::array<double, 5> truth{};
        for (std::size_t i = 0; i < truth.size(); ++i)
          truth[i] = surfaces::mean_threshold(population, surfaces::deviations[i]);
        std::vector<Bands> all(pilots());
#pragma omp parallel for schedule(dynamic)
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = bands_of(population, truth, i + 1);
        const auto refused =
            std::count_if(all.begin(), all.end(), [](const Bands& one) { return !one.given; });
        std::printf("| %s | %g, %g | %.3f", population.name.c_str(), a, b,
                    static_cast<double>(refused) / static_cast<double>(all.size()));
        print_shares(all, &Bands::direct);
        print_shares(all, &Bands::solver);
        std::printf(" |\n");
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace
