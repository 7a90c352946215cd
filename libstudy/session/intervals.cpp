#include <cmath>

#include "libstudy/session/session.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

/// Converts hold counts to nanoseconds without accumulating rounding errors.
std::vector<std::int64_t> holds_ns(const std::vector<int>& holds, double refresh_hz) {
  std::vector<std::int64_t> intervals;
  std::int64_t periods = 0, before = 0;
  for (const int hold : holds) {
    periods += hold;
    const std::int64_t now = std::llround(static_cast<double>(periods) * 1e9 / refresh_hz);
    intervals.push_back(now - before);
    before = now;
  }
  return intervals;
}

}  // namespace

std::vector<std::int64_t> trial_intervals(const Protocol& protocol, const FpsSetting& setting,
                                          const Display& display, std::uint64_t schedule_seed) {
  const double refresh_hz = display.refresh_hz();
  const PacingRules rules = for_display(protocol.pacing, refresh_hz);
  if (refresh_hz == 0) return compile_schedule(setting, rules, schedule_seed).intervals_ns;

  const RefreshVerdict found = quantise(setting, rules, refresh_hz, schedule_seed);
  const bool shown = found.feasibility == Feasibility::Exact ||
                     (found.feasibility == Feasibility::Approximate && protocol.accept_approximate);
  if (!shown) {
    throw base::Error(protocol.name + " on " + display.description(),
                      "setting " + setting_name(setting) + " cannot be shown: " + found.reason,
                      "see vip-study check --refresh; use another display or accept_approximate = true");
  }
  return holds_ns(found.holds, display.measured_hz());
}

void check_settings(const Protocol& protocol, const Display& display) {
  if (protocol.design.timing == TimingSource::Native) return;
  for (const Cell& cell : protocol.design.cells) trial_intervals(protocol, cell.setting, display, 0);
}

}  // namespace study
