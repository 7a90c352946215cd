#include "libstudy/headset/outside_eyes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace study {

namespace {

constexpr std::size_t most_slots_kept = 128;
constexpr std::int64_t oldest_followed_ns = 200'000'000;

std::array<float, 4> product(const std::array<float, 4>& a, const std::array<double, 4>& right) {
  const auto b = [&](std::size_t k) { return static_cast<float>(right[k]); };
  return {a[3] * b(0) + a[0] * b(3) + a[1] * b(2) - a[2] * b(1),
          a[3] * b(1) - a[0] * b(2) + a[1] * b(3) + a[2] * b(0),
          a[3] * b(2) + a[0] * b(1) - a[1] * b(0) + a[2] * b(3),
          a[3] * b(3) - a[0] * b(0) - a[1] * b(1) - a[2] * b(2)};
}

/// The shortest rotation from straight ahead (-z) to a direction, as a unit quaternion x, y, z, w.
std::array<double, 4> turn_to(const std::array<double, 3>& direction) {
  const double w = 1 - direction[2], length = std::hypot(direction[0], direction[1], w);
  if (length < 1e-9) return {0, 1, 0, 0};  // straight behind
  return {direction[1] / length, -direction[0] / length, 0, w / length};
}

}  // namespace

HeadsetGaze gaze_in_room(const TrackedGaze& sample, const HeadsetPose& head) {
  HeadsetGaze out;
  out.sampled_ns = sample.sampled_ns;
  out.device_ns = sample.device_ns;
  out.ray = head;
  out.ray.turn_valid = sample.valid && head.turn_valid;
  out.ray.turn_tracked = sample.valid && head.turn_tracked;
  if (out.ray.turn_valid) out.ray.turn = product(head.turn, turn_to(sample.direction));
  return out;
}

std::vector<HeadsetRecord> OutsideEyes::join(std::span<const HeadsetRecord> slots,
                                             std::span<const TrackedGaze> samples) {
  slots_.insert(slots_.end(), slots.begin(), slots.end());
  while (slots_.size() > most_slots_kept) slots_.pop_front();
  if (!samples.empty()) sample_ = samples.back();
  std::vector<HeadsetRecord> out;
  if (slots_.empty()) return out;
  for (const TrackedGaze& sample : samples) {
    const auto distance = [&](const HeadsetRecord& slot) {
      return std::abs(slot.slot.predicted_ns - sample.sampled_ns);
    };
    const auto nearest = std::min_element(slots_.begin(), slots_.end(), [&](const auto& a, const auto& b) {
      return distance(a) < distance(b);
    });
    out.push_back(*nearest);
    out.back().input.gaze = gaze_in_room(sample, nearest->input.head);
  }
  return out;
}

std::optional<HeadsetRecord> OutsideEyes::newest() const {
  if (slots_.empty()) return {};
  HeadsetRecord record = slots_.back();
  record.input.gaze.reset();
  if (sample_ && record.slot.predicted_ns - sample_->sampled_ns <= oldest_followed_ns)
    record.input.gaze = gaze_in_room(*sample_, record.input.head);
  return record;
}

}  // namespace study
