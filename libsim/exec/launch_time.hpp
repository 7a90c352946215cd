#pragma once
/// Durations of launches, summed by label, for benches.

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace sim {

/// Total of the launches with one label since profile_launches(true).
struct LaunchTime {
  std::string label;
  int launches = 0;
  double ms = 0;  ///< from launch to end, on the device's clock if it has one
};

/// The entries in descending order of time, each with its label (the key).
inline std::vector<LaunchTime> longest_first(const std::map<std::string, LaunchTime>& passes) {
  std::vector<LaunchTime> out;
  for (const auto& [label, pass] : passes) out.push_back({label, pass.launches, pass.ms});
  std::sort(out.begin(), out.end(), [](const LaunchTime& a, const LaunchTime& b) { return a.ms > b.ms; });
  return out;
}

}  // namespace sim
