#pragma once
/// Frame costs of live stimuli on a session's station, stored in its event log: measured before the session,
/// at full speed, on the session's display (docs/data.md).

#include <string>
#include <vector>

#include "libstudy/protocol/design.hpp"

namespace study {

inline constexpr const char* frame_costs_event = "frame costs";

/// Costs of one stimulus: the time to compute and draw a frame without waiting.
struct FrameCosts {
  StimulusSpec what;
  double mean_ms = 0, p95_ms = 0;
  bool operator==(const FrameCosts&) const = default;
};

/// Frame costs as JSON on one line.
std::string format_frame_costs(const std::vector<FrameCosts>& costs);
/// base::Error naming `place` for anything that format_frame_costs() does not write.
std::vector<FrameCosts> parse_frame_costs(const std::string& text, const std::string& place);

}  // namespace study
