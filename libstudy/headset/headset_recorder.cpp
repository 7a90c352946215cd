#include "libstudy/headset/headset_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace study {

namespace {

using Triple = std::array<double, 3>;

Triple wide(const std::array<float, 3>& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

/// Converts a direction of the room to the frame of a pose: its right, up and back components.
Triple into(const HeadsetPose& pose, const Triple& direction) {
  const auto axes = axes_of(pose);
  Triple out{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t k = 0; k < 3; ++k) out[row] += static_cast<double>(axes[3 * row + k]) * direction[k];
  }
  return out;
}

/// The point of an eye's picture in a direction of the room; none if the direction points behind the eye.
std::optional<GazePoint> point_of(const HeadsetEye& eye, const Triple& direction) {
  const Triple d = into(eye.pose, direction);
  if (!eye.pose.turn_valid || !(d[2] < 0)) return {};
  const auto slope = [](float angle) { return std::tan(static_cast<double>(angle)); };
  const double left = slope(eye.fov.left), right = slope(eye.fov.right);
  const double up = slope(eye.fov.up), down = slope(eye.fov.down);
  return GazePoint{(d[0] / -d[2] - left) / (right - left), (up - d[1] / -d[2]) / (up - down)};
}

HeadPose head_of(const HeadsetPose& head) {
  HeadPose out;
  out.place_m = wide(head.place_m);
  for (std::size_t k = 0; k < 4; ++k) out.turn[k] = static_cast<double>(head.turn[k]);
  out.place_valid = head.place_valid;
  out.turn_valid = head.turn_valid;
  out.place_tracked = head.place_tracked;
  out.turn_tracked = head.turn_tracked;
  return out;
}

EyeFacts facts_of(const HeadsetEye& eye) {
  const auto degrees = [](float angle) { return static_cast<double>(angle) * 180 / std::numbers::pi; };
  return {eye.width_px,           eye.height_px,       degrees(eye.fov.left),
          degrees(eye.fov.right), degrees(eye.fov.up), degrees(eye.fov.down)};
}

/// The pose whose direction counts as gaze: of the eye tracker (`eyes`) or of the head; null if not valid.
const HeadsetPose* followed(const HeadsetRecord& record, bool eyes) {
  const bool seen = record.input.gaze && record.input.gaze->ray.turn_valid;
  if (eyes) return seen ? &record.input.gaze->ray : nullptr;
  return record.input.head.turn_valid ? &record.input.head : nullptr;
}

}  // namespace

GazeSample gaze_of(const HeadsetRecord& record, GazeOrigin origin) {
  GazeSample sample;
  sample.sampled_ns = record.slot.predicted_ns;
  sample.tracked = false;
  const bool eyes = origin == GazeOrigin::Tracker;
  const HeadsetPose& head = record.input.head;
  const HeadsetPose* const pose = followed(record, eyes);
  if (eyes && record.input.gaze) {
    sample.device_ns = record.input.gaze->sampled_ns;
    sample.sampled_ns = sample.device_ns.value_or(sample.sampled_ns);
    if (record.input.gaze->device_ns) sample.device_ns = record.input.gaze->device_ns;
  }
  if (!pose || !head.turn_valid) return sample;
  const Triple direction = wide(direction_of(*pose)), place = wide(pose->place_m), from = wide(head.place_m);
  sample.valid = true;
  sample.tracked = pose->turn_tracked;
  GazeRay& ray = sample.ray.emplace();
  ray.direction = into(head, direction);
  // The point refers to the picture as it was drawn, perhaps with a margin and for an earlier head pose.
  if (record.shown)
    sample.point = point_of(record.shown->views[0], record.shown->in_head ? ray.direction : direction);
  if (pose->place_valid && head.place_valid)
    ray.origin_m = into(head, {place[0] - from[0], place[1] - from[1], place[2] - from[2]});
  return sample;
}

std::optional<double> ipd_of(const EyeViews& views) {
  if (!can_be_shown(views)) return {};
  const auto &left = views[0].pose.place_m, &right = views[1].pose.place_m;
  const double m =
      std::hypot(static_cast<double>(right[0] - left[0]), static_cast<double>(right[1] - left[1]),
                 static_cast<double>(right[2] - left[2]));
  return m > 0 ? std::optional(1000 * m) : std::nullopt;
}

void HeadsetRecorder::drain() {
  const std::vector<HeadsetRecord> records = display_.take_for_record();
  if (outside_) {
    const std::vector<TrackedGaze> samples = outside_->take();
    for (const HeadsetRecord& record : eyes_.join(records, samples))
      gaze_.push_back(gaze_of(record, GazeOrigin::Tracker));
  }
  for (const HeadsetRecord& record : records) {
    if (allowed_ && !outside_) add_gaze(record);
    const HeadsetSlot& slot = record.slot;
    slots_.push_back({slot.predicted_ns, slot.period_ns, slot.should_render, {}, 0});
    if (with_heads_) slots_.back().head = head_of(record.input.head);
    slots_.back().ipd_mm = ipd_of(record.views).value_or(0);
    newest_ = record;
  }
}

void HeadsetRecorder::add_gaze(const HeadsetRecord& record) {
  GazeSample sample = gaze_of(record, origin_);
  const bool told = sample.device_ns.has_value(), again = told && *sample.device_ns <= last_reported_ns_;
  if (again && sample.valid) return;
  if (told && !again) {
    last_reported_ns_ = *sample.device_ns;
    lag_ns_ = std::max(lag_ns_, record.slot.predicted_ns - last_reported_ns_);
  } else if (!sample.valid) {
    // The eyes are lost. The runtime may still report the time of the last valid sample; this time is not
    // used.
    sample.device_ns.reset();
    sample.sampled_ns = std::max(record.slot.predicted_ns - lag_ns_, last_ns_);
  }
  last_ns_ = sample.sampled_ns;
  gaze_.push_back(sample);
}

void HeadsetRecorder::start() {
  drain();
  allowed_ = true;
  if (outside_) outside_->start();
}

std::vector<GazeSample> HeadsetRecorder::take() {
  drain();
  return std::exchange(gaze_, {});
}

void HeadsetRecorder::stop() {
  allowed_ = false;
  gaze_.clear();
  if (outside_) outside_->stop();
}

std::optional<TrackerClock> HeadsetRecorder::clock() {
  return outside_ ? std::optional(outside_->clock()) : std::nullopt;
}

std::vector<TrackerClock> HeadsetRecorder::take_clocks() {
  return outside_ ? outside_->take_clocks() : std::vector<TrackerClock>();
}

std::vector<std::string> HeadsetRecorder::take_gaze_news() {
  return outside_ ? outside_->take_news() : std::vector<std::string>();
}

HeadsetFacts HeadsetRecorder::facts() const {
  const SessionFacts session = display_.session();
  const HeadsetNames& names = session.names;
  HeadsetFacts out;
  out.runtime = names.runtime;
  out.runtime_version = names.runtime_version;
  out.headset = names.headset;
  out.format = names.format;
  out.blend = names.blend;
  out.position_tracking = names.position_tracking;
  out.times_convert = session.times_convert;
  out.eye_tracking = session.eye_gaze;
  out.hold = hold_name(display_.rules().hold);
  const HeadsetRate rate = display_.facts().rate;
  out.refresh_told_hz = rate.reported_hz;
  out.refresh_measured_hz = rate.measured_hz;
  const EyeViews views = display_.facts().views;
  for (std::size_t eye = 0; eye < views.size(); ++eye) out.eyes[eye] = facts_of(views[eye]);
  return out;
}

std::vector<HeadsetFacts> HeadsetRecorder::take_facts() {
  std::vector<HeadsetFacts> out;
  for (const HeadsetRate& rate : display_.take_rates()) {
    out.push_back(facts());
    out.back().refresh_told_hz = rate.reported_hz;
    out.back().refresh_measured_hz = rate.measured_hz;
  }
  return out;
}

void HeadsetRecorder::start_slots(bool with_heads) {
  with_heads_ = with_heads;
  drain();
  slots_.clear();
}

std::vector<SlotRecord> HeadsetRecorder::take_slots() {
  drain();
  return std::exchange(slots_, {});
}

std::optional<double> HeadsetRecorder::ipd_mm() { return ipd_of(display_.facts().views); }

std::optional<RoomRay> HeadsetRecorder::ray() {
  drain();
  const std::optional<HeadsetRecord> newest = outside_ ? eyes_.newest() : newest_;
  if (!newest) return {};
  const HeadsetPose* const pose = followed(*newest, allowed_ && origin_ == GazeOrigin::Tracker);
  if (!pose || !pose->valid()) return {};
  Triple place = wide(pose->place_m);
  for (double& along : place) along /= display_.rules().world_scale;
  return RoomRay{place, wide(direction_of(*pose))};
}

}  // namespace study
