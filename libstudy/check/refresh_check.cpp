#include "libstudy/check/refresh_check.hpp"

#include <algorithm>
#include <tuple>

#include "libstudy/pacing/nominal_refresh.hpp"

namespace study {

std::vector<CheckedSetting> checked_settings(const Protocol& protocol) {
  std::vector<CheckedSetting> out;
  if (protocol.design.timing == TimingSource::Native) return out;
  for (std::size_t i = 0; i < protocol.design.cells.size(); ++i) {
    const FpsSetting& setting = protocol.design.cells[i].setting;
    const auto known = std::find_if(out.begin(), out.end(),
                                    [&](const CheckedSetting& other) { return other.setting == setting; });
    if (known == out.end())
      out.push_back({setting, {static_cast<int>(i)}});
    else
      known->cells.push_back(static_cast<int>(i));
  }
  return out;
}

std::vector<std::int64_t> intervals_on(const RefreshCheck& check, const std::vector<CheckedSetting>& settings,
                                       const FpsSetting& setting) {
  for (std::size_t i = 0; i < settings.size(); ++i) {
    if (settings[i].setting != setting || check.verdicts[i].holds.empty()) continue;
    return schedule_of_holds(check.verdicts[i].holds, check.refresh_hz).intervals_ns;
  }
  return {};
}

RefreshCheck check_refresh(const Protocol& protocol, double refresh_hz) {
  RefreshCheck check;
  check.asked_hz = refresh_hz;
  check.refresh_hz = nominal_refresh(refresh_hz);
  for (const auto& [setting, cells] : checked_settings(protocol)) {
    // The last argument is a seed: it orders the frame intervals and places the hitches. Trials use other
    // seeds.
    check.verdicts.push_back(quantise(setting, protocol.pacing, check.refresh_hz, 0));
    const auto& verdict = check.verdicts.back();
    check.exact += verdict.feasibility == Feasibility::Exact;
    check.approximate += verdict.feasibility == Feasibility::Approximate;
    check.unreachable += verdict.feasibility == Feasibility::Unreachable;
    if (verdict.feasibility != Feasibility::Unreachable) check.distance += verdict.distance;
  }
  if (const int reached = check.exact + check.approximate; reached > 0) check.distance /= reached;
  return check;
}

const RefreshCheck& best_refresh(const std::vector<RefreshCheck>& checks) {
  const auto rank = [](const RefreshCheck& check) {
    return std::make_tuple(-check.exact, check.unreachable, check.distance);
  };
  return *std::min_element(checks.begin(), checks.end(),
                           [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
}

double play_speed(const Protocol& protocol, const FpsSetting& setting) {
  return protocol.content.real_time ? 1 : setting.mean * protocol.content.content_step_s;
}

}  // namespace study
