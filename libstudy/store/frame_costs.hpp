#pragma once
/// What the frames of live stimuli cost on a session's station, as its event log holds it: measured before
/// the session, at full speed, on the display that it plays on (docs/records.md).

#include <string>
#include <vector>

#include "libstudy/protocol/design.hpp"

namespace study {

inline constexpr const char* frame_costs_event = "frame costs";

/// Of one stimulus under one wish for its frame rate. A frame is computed and drawn, with nothing to wait
/// for.
struct FrameCosts {
  StimulusSpec what;
  double mean_ms = 0, p95_ms = 0;
  bool operator==(const FrameCosts&) const = default;
};

/// JSON on one line.
std::string format_frame_costs(const std::vector<FrameCosts>& costs);
/// base::Error naming `place` for anything that format_frame_costs() does not write.
std::vector<FrameCosts> parse_frame_costs(const std::string& text, const std::string& place);

}  // namespace study
