#include "libstudy/analysis/ptpe/truth.hpp"

#include <fmt/core.h>
#include <array>

#include "libstudy/observer/ptpe_observer.hpp"
#include "stats/base/error.hpp"
#include "stats/base/json.hpp"

namespace study {

namespace {

bool holds(const std::array<double, 2>& interval, double value) {
  return interval[0] <= value && value <= interval[1];
}

std::string line(const char* name, const std::array<double, 2>& interval, bool held, double truth) {
  return fmt::format("  {}: the interval [{:.4g}, {:.4g}] {} the true {:g}\n", name, interval[0], interval[1],
                     held ? "holds" : "does NOT hold", truth);
}

}  // namespace

stats::PtpeModel parse_truth(const std::string& observer) {
  const auto parameters = parse_ptpe_observer(observer);
  return {parameters.a, parameters.b};
}

void check_comparable(const PilotFit& fit, const std::string& observer) {
  const auto& scale = fit.data.question;
  const double middle = (scale.scale_min + scale.scale_max) / 2.0;
  if (fit.level == middle) return;
  throw base::Error("--truth " + observer,
                    fmt::format("is the observer's curve at the middle of the scale, {:g}, and the fit is at "
                                "level {:g}",
                                middle, fit.level),
                    fmt::format("write --level {:g}, or leave --truth out", middle));
}

Recovery check_recovery(const PilotFit& fit, const stats::PtpeModel& truth) {
  const auto main = fit.main();
  const auto& spread = *main.spread;
  return {truth, holds(spread.a_ci, truth.a), holds(spread.b_ci, truth.b)};
}

std::string format_recovery(const PilotFit& fit, const Recovery& recovery) {
  const auto main = fit.main();
  const auto& spread = *main.spread;
  return fmt::format("against the observer's truth (level {:.3g}, harmonic mean):\n", fit.level) +
         line("a", spread.a_ci, recovery.a_held, recovery.truth.a) +
         line("b", spread.b_ci, recovery.b_held, recovery.truth.b);
}

base::Json recovery_json(const Recovery& recovery) {
  return {{"a", recovery.truth.a},
          {"b", recovery.truth.b},
          {"a_ci_holds_it", recovery.a_held},
          {"b_ci_holds_it", recovery.b_held}};
}

}  // namespace study
