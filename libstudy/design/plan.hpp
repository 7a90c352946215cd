#pragma once
/// Who sees what in which order: a pure function of (protocol hash, participant, seed).

#include <cstdint>
#include <string>
#include <vector>

#include "libstudy/design/random.hpp"
#include "libstudy/protocol/protocol.hpp"

namespace study {

/// One planned trial.
struct PlannedTrial {
  int position = 0;                 ///< 0-based order of presentation
  int setting = 0;                  ///< index into Protocol::settings
  std::uint64_t schedule_seed = 0;  ///< orders the intervals
};

/// All settings once each in random order: a seeded Fisher-Yates shuffle. A trial's schedule_seed depends on
/// its setting, not on its position.
std::vector<PlannedTrial> make_plan(const Protocol& protocol, const std::string& participant,
                                    std::uint64_t seed);

}  // namespace study
