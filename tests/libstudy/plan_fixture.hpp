#pragma once
/// Helpers for tests of plans.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "libstudy/design/plan.hpp"
#include "stats/base/file.hpp"

namespace study::test {

inline Protocol shipped(const std::string& name) {
  return study::read_protocol(base::resource("protocols/" + name + ".toml"));
}

inline const study::StimulusSpec& stimulus_of(const Protocol& protocol, int cell) {
  return protocol.design.cells.at(static_cast<std::size_t>(cell)).stimulus;
}

inline study::BlockKind kind_of(const Protocol& protocol, int block) {
  return protocol.blocks.at(static_cast<std::size_t>(block)).kind;
}

/// The trials of the design, without practice.
inline std::vector<PlannedTrial> design_trials(const Protocol& protocol, const Plan& plan) {
  std::vector<PlannedTrial> out;
  for (const auto& trial : plan.trials) {
    if (kind_of(protocol, trial.block) == study::BlockKind::Stimulus) out.push_back(trial);
  }
  return out;
}

inline std::vector<int> order_of(const Plan& plan) {
  std::vector<int> order;
  for (const auto& trial : plan.trials) order.push_back(trial.first);
  return order;
}

/// Standardised chi-square of counts against their mean: (scale chi2 - freedom) / sqrt(2 freedom).
inline double chi_square_z(const std::vector<int>& counts, double freedom, double scale = 1) {
  const double expected = std::accumulate(counts.begin(), counts.end(), 0.0) / double(counts.size());
  double chi2 = 0;
  for (const int count : counts) chi2 += (count - expected) * (count - expected) / expected;
  return (scale * chi2 - freedom) / std::sqrt(2 * freedom);
}

}  // namespace study::test
