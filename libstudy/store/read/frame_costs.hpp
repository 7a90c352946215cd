#pragma once
/// Frame costs: times to compute and draw a frame of live stimuli. They are measured before a session, at
/// full speed, on the session's station and display, and stored in the session's event log (docs/data.md).

#include <string>
#include <vector>

#include "libstudy/protocol/design.hpp"

namespace study {

inline constexpr const char* frame_costs_event = "frame costs";

/// The time to compute and draw a frame of one stimulus without waiting: mean and 95th percentile.
struct FrameCosts {
  StimulusSpec what;
  double mean_ms = 0, p95_ms = 0;
  bool operator==(const FrameCosts&) const = default;
};

/// Frame costs as JSON on one line.
std::string format_frame_costs(const std::vector<FrameCosts>& costs);
/// Parses the text of format_frame_costs(). base::Error, which names `place`, for any other text.
std::vector<FrameCosts> parse_frame_costs(const std::string& text, const std::string& place);

}  // namespace study
