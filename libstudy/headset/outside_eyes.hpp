#pragma once
/// Gives the samples of an eye tracker outside OpenXR a place among a headset's slots.

#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "libstudy/headset/frame_loop.hpp"
#include "libstudy/trackers/eye_tracker.hpp"

namespace study {

/// Keeps the records of the last slots, about a second, and joins each sample with the slot whose predicted
/// time is nearest to the sample's: the slot's head pose carries the sample's ray into the room, and its
/// picture is the one that the eyes saw. The session's clock must be CLOCK_MONOTONIC, as it is with a runtime
/// whose times convert.
class OutsideEyes {
 public:
  /// Takes in new records of slots, and returns a record for each sample: that of its slot, with the sample
  /// as the gaze of its input.
  std::vector<HeadsetRecord> join(std::span<const HeadsetRecord> slots, std::span<const TrackedGaze> samples);
  /// The newest slot with the newest sample as its gaze; none without a slot. Without a gaze if the sample is
  /// older than 0.2 s.
  std::optional<HeadsetRecord> newest() const;

 private:
  std::deque<HeadsetRecord> slots_;
  std::optional<TrackedGaze> sample_;
};

/// The sample's ray in the room, from the middle between the eyes.
HeadsetGaze gaze_in_room(const TrackedGaze& sample, const HeadsetPose& head);

}  // namespace study
