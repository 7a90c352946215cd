#include "apps/stats/fit_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/ptpe/estimates_json.hpp"
#include "libstudy/analysis/ptpe/pilot_people_json.hpp"
#include "stats/base/json.hpp"

namespace apps {

namespace {

std::string rates(const std::array<double, 2>& ci, int decimals) {
  if (ci[1] > study::highest_rate) return fmt::format("[{:.{}f}, no upper bound]", ci[0], decimals);
  return fmt::format("[{:.{}f}, {:.{}f}]", ci[0], decimals, ci[1], decimals);
}

std::string slopes(const std::array<double, 2>& ci) {
  const int decimals = study::interval_decimals(ci, 4);
  return fmt::format("[{:.{}f}, {:.{}f}]", ci[0], decimals, ci[1], decimals);
}

/// Prints one line: a, b and their intervals, or the reason why there is no estimate.
void print_estimate(double level, const char* name, const std::string& reason, double a, double b,
                    const std::array<double, 2>* a_ci, const std::array<double, 2>* b_ci) {
  std::printf("  level %-4.3g %-26s ", level, name);
  if (!reason.empty() && !a_ci) {
    std::printf("%s\n", reason.c_str());
    return;
  }
  std::printf("a = %.2f %s frames/s, b = %.4f %s s/frame\n", a, rates(*a_ci, 2).c_str(), b,
              slopes(*b_ci).c_str());
}

void print_estimate(double level, const char* name, const stats::Result<stats::CurveSpread>& spread) {
  if (!spread) return print_estimate(level, name, spread.reason(), 0, 0, nullptr, nullptr);
  print_estimate(level, name, "", spread->curve.a(), spread->curve.b, &spread->a_ci, &spread->b_ci);
}

void print_contour(double level, const char* name, const stats::PilotEstimate& contour) {
  if (!contour.spread) return print_estimate(level, name, contour.spread.reason(), 0, 0, nullptr, nullptr);
  print_estimate(level, name, "", contour.fit->a, contour.fit->b, &contour.spread->a_ci,
                 &contour.spread->b_ci);
}

/// Prints " mu(0) = 23.1 [22.0, 24.3], mu(5) = ...": the curve at each of `deltas`, with intervals.
template <class Curve>
void print_points(const std::vector<double>& deltas, const Curve& curve) {
  for (const double delta : deltas) {
    const auto point = curve.band(delta);
    std::printf("%s mu(%g) = %.1f %s", delta == deltas.front() ? "" : ",", delta, point.mu,
                rates(point.pointwise, 1).c_str());
  }
  std::printf("\n");
}

/// Prints the curve and its band at the standard deviations of the shown frame rates, the test of the curve's
/// form, and the lack-of-fit test.
void print_curve(const study::PilotFit& fit) {
  const auto& direct = fit.chosen().direct;
  if (!direct.jackknife) return;
  std::printf("  the direct curve at level %.3g:", fit.level);
  print_points(fit.deltas, *direct.jackknife);
  if (const auto& band = fit.chosen().band) {
    std::printf("  the band of the curve at level %.3g:", fit.level);
    print_points(fit.deltas, *band);
  }
  if (direct.form) {
    std::printf("  form of the curve: %s\n", stats::form_text(*direct.form).c_str());
    if (direct.form->rejected()) {
      std::printf("  the free curve at level %.3g:", fit.level);
      print_points(fit.deltas, direct.form->curve);
    }
  }
  const auto test = study::lack_of_fit_json(direct);
  if (test.contains("text"))
    std::printf("  shape of the scores: %s\n", test["text"].get<std::string>().c_str());
}

void print_raters(const study::PilotFit& fit) {
  const auto raters = study::raters_json(fit);
  for (const char* part : {"reverse_coders", "drift", "lapses"}) {
    const auto& one = raters[part];
    const std::string text = one.contains("text") ? one["text"].get<std::string>()
                                                  : "not tested: " + one["refused"].get<std::string>();
    std::string name = part;
    std::replace(name.begin(), name.end(), '_', ' ');
    std::printf("  %s: %s\n", name.c_str(), text.c_str());
  }
  for (const std::string& one : study::reverse_coders(fit))
    std::printf("    reverse coder: %s\n", one.c_str());
}

}  // namespace

void print_fit(const study::PilotFit& fit) {
  std::printf(
      "%d participants, %zu ratings of %zu settings\nmu = a exp(b delta) with %.0f %% intervals over "
      "participants:\n",
      fit.participants, fit.data.ratings.size(), fit.settings, 100 * fit.bootstrap.confidence);
  for (const auto& [level, estimate] : fit.harmonic) {
    print_estimate(level, "direct", estimate.direct.jackknife);
    print_contour(level, "contour (the paper's)", estimate.contour);
    print_estimate(level, "ordinal mixed", estimate.ordinal.jackknife);
    print_estimate(level, "direct, arithmetic mean", fit.arithmetic.at(level).direct.jackknife);
    print_contour(level, "contour, arithmetic mean", fit.arithmetic.at(level).contour);
  }
  const auto main = fit.main();
  if (main.spread)
    print_estimate(fit.level, fit.doubts.empty() ? "for the solver" : "not for a solver", "", main.fit->a,
                   main.fit->b, &main.spread->a_ci, &main.spread->b_ci);
  print_curve(fit);
  print_raters(fit);
  for (const auto& flag : fit.flags) std::printf("  note: %s\n", flag.text.c_str());
}

}  // namespace apps
