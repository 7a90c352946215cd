#include "libstudy/headset/headset_targets.hpp"

#include <epoxy/gl.h>

#include <cmath>
#include <numbers>

#include "stats/base/error.hpp"

namespace study {

namespace {

/// Distance of the targets, m: about the focal distance of headsets' lenses.
constexpr double distance_m = 2;
/// Visual angle of a target's width; width of the black dot divided by the width of the target.
constexpr double size_deg = 1, dot_share = 0.2;
/// Longest call of check() after which the samples still count, ns. A longer call means that check() showed
/// the participant another page.
constexpr std::int64_t most_checking_ns = 200'000'000;
constexpr int most_turns = 200;  ///< slots to wait for a valid head pose

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

using Turn = std::array<float, 4>;

Turn multiply(const Turn& a, const Turn& b) {
  return {a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
          a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
          a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
          a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
}

float half_sin(double degrees) { return static_cast<float>(std::sin(radians(degrees) / 2)); }
float half_cos(double degrees) { return static_cast<float>(std::cos(radians(degrees) / 2)); }

TargetSample sample_of(const HeadsetRecord& record, const HeadsetPose& target) {
  TargetSample sample;
  if (!record.input.gaze || !record.input.gaze->ray.turn_valid) return sample;
  const HeadsetPose& ray = record.input.gaze->ray;
  const auto& from = ray.place_valid ? ray.place_m : record.input.head.place_m;
  const auto along = direction_of(ray);
  sample.valid = ray.place_valid || record.input.head.place_valid;
  for (std::size_t k = 0; k < 3; ++k) {
    sample.gaze[k] = static_cast<double>(along[k]);
    sample.target[k] = static_cast<double>(target.place_m[k] - from[k]);
  }
  return sample;
}

}  // namespace

HeadsetPage target_page(const HeadsetPose& head, double azimuth_deg, double elevation_deg) {
  HeadsetPage page;
  page.pose = head;
  const Turn yaw{0, half_sin(-azimuth_deg), 0, half_cos(azimuth_deg)};
  const Turn pitch{half_sin(elevation_deg), 0, 0, half_cos(elevation_deg)};
  page.pose.turn = multiply(head.turn, multiply(yaw, pitch));
  const auto ahead = direction_of(page.pose);
  for (std::size_t k = 0; k < 3; ++k) page.pose.place_m[k] += static_cast<float>(distance_m) * ahead[k];
  page.width_m = page.height_m = static_cast<float>(2 * distance_m * std::tan(radians(size_deg) / 2));
  return page;
}

std::vector<HeadsetRecord> HeadsetTargets::take_records() {
  std::vector<HeadsetRecord> records = display_.take_for_record();
  return outside_ ? eyes_.join(records, outside_->take()) : records;
}

void HeadsetTargets::end() {
  display_.hide_page();
  if (outside_) outside_->stop();
}

void HeadsetTargets::begin() {
  if (outside_) outside_->start();
  display_.take_for_record();
  for (int turn = 0; turn < most_turns; ++turn) {
    display_.turn();
    for (const HeadsetRecord& record : display_.take_for_record()) {
      if (!record.input.head.valid()) continue;
      middle_ = record.input.head;
      world_ = record.world;
      return;
    }
  }
  throw base::Error("headset", "it does not report where the head is",
                    "check its tracking, and continue with vip-study resume");
}

/// Draws a white target with a black dot in the middle.
void HeadsetTargets::draw() {
  const sim::Offscreen& page = display_.page();
  const float white[4] = {1, 1, 1, 1}, black[4] = {0, 0, 0, 1};
  glClearNamedFramebufferfv(page.framebuffer(), GL_COLOR, 0, white);
  const int width = std::max(1, static_cast<int>(dot_share * page.width()));
  const int height = std::max(1, static_cast<int>(dot_share * page.height()));
  glEnable(GL_SCISSOR_TEST);
  glScissor((page.width() - width) / 2, (page.height() - height) / 2, width, height);
  glClearNamedFramebufferfv(page.framebuffer(), GL_COLOR, 0, black);
  glDisable(GL_SCISSOR_TEST);
}

std::vector<TargetSample> HeadsetTargets::look_at(double azimuth_deg, double elevation_deg, double settle_s,
                                                  double sample_s, const std::function<void()>& check) {
  // Repeats until the target was visible throughout: no other page in front, headset worn, no move of the
  // world's origin.
  for (;;) {
    if (world_ != display_.facts().world && display_.focused()) begin();
    const HeadsetPage page = target_page(middle_, azimuth_deg, elevation_deg);
    if (auto samples = look_once(page, settle_s, sample_s, check)) return *samples;
  }
}

std::optional<std::vector<TargetSample>> HeadsetTargets::look_once(const HeadsetPage& page, double settle_s,
                                                                   double sample_s,
                                                                   const std::function<void()>& check) {
  draw();
  display_.show_page(page);
  const std::int64_t from_ns = display_.now_ns() + std::llround(1e9 * settle_s);
  const std::int64_t until_ns = from_ns + std::llround(1e9 * sample_s);
  take_records();
  std::vector<TargetSample> samples;
  std::int64_t last_ns = 0;
  while (display_.now_ns() < until_ns) {
    const std::int64_t before_ns = display_.now_ns();
    if (check) check();
    const bool moved = display_.facts().world != world_;
    if (display_.now_ns() - before_ns > most_checking_ns || moved || !display_.focused()) {
      display_.turn();
      return {};
    }
    display_.turn();
    for (const HeadsetRecord& record : take_records()) {
      if (record.slot.predicted_ns < from_ns) continue;
      const auto sampled_ns = record.input.gaze ? record.input.gaze->sampled_ns : std::nullopt;
      if (sampled_ns && *sampled_ns <= last_ns) continue;  // a sample that was already counted
      last_ns = sampled_ns.value_or(last_ns);
      samples.push_back(sample_of(record, page.pose));
    }
  }
  return samples;
}

}  // namespace study
