/// The scripted hand and eyes, and the targets that they point at on a page.

#include "tests/headset/parts.hpp"

namespace simulated {

namespace {

double knob(const char* name) { return runtime().knobs.at(name); }
double seconds(XrDuration duration) { return 1e-9 * static_cast<double>(duration); }

/// A pose whose forward direction, -z, points from one place to another.
Pose aimed(Vector from, Vector to) {
  const Vector way = to + -1.0 * from;
  const double level = std::sqrt(way.x * way.x + way.z * way.z);
  const double yaw = std::atan2(-way.x, -way.z), pitch = std::atan2(way.y, level);
  return {turned(yaw / radians_per_degree, pitch / radians_per_degree, 0), from};
}

/// Index of the target to point at now, and the elapsed fraction of the `hold` seconds until the next target.
struct Turn {
  std::size_t target;
  double part;
};
Turn turn_at(XrTime time) {
  const Runtime& all = runtime();
  const double turns = std::fmax(0, seconds(time - all.page->since) / knob("hold"));
  const double whole = std::floor(turns);
  return {static_cast<std::size_t>(whole) % all.profile.targets.size(), turns - whole};
}

/// Position of the current target in the space STAGE, m.
Vector target_at(XrTime time) {
  const Runtime& all = runtime();
  const auto [u, v] = all.profile.targets[turn_at(time).target];
  const Page& page = *all.page;
  return (place_of(page.space, time) * page.pose *
          Pose{{}, {(u - 0.5) * page.width, (0.5 - v) * page.height, 0}})
      .p;
}

bool shows_targets() { return runtime().page && !runtime().profile.targets.empty(); }

}  // namespace

Pose hand_at(XrTime time) {
  const Vector hand{0.2, 1.2, -0.2};
  if (runtime().profile.point == "page" && shows_targets()) return aimed(hand, target_at(time));
  return {turned(knob("aim_yaw"), knob("aim_pitch"), 0), hand};
}

bool presses_page() {
  if (runtime().profile.point != "page" || !shows_targets()) return false;
  const double part = turn_at(now()).part;
  return part >= 0.7 && part < 0.9;
}

Gaze gaze_at(XrTime time) {
  const Runtime& all = runtime();
  // The newest sample that has arrived. The eye tracker takes its samples on a time grid of its own, which
  // begins 3.1 ms after the clock's start. A sample arrives `gaze_age` ms after it was taken.
  const double rate = knob("gaze_rate");
  const auto age = static_cast<XrDuration>(1e6 * knob("gaze_age"));
  const XrDuration since = std::min(time, now()) - age - all.clock.start - 3'100'000;
  const auto number = static_cast<std::int64_t>(std::floor(seconds(since) * rate));
  Gaze out;
  out.time = all.clock.start + 3'100'000 +
             static_cast<XrDuration>(std::floor(1e9 * static_cast<double>(number) / rate));
  const double every = knob("blink_every");
  const bool blinks =
      every > 0 && std::fmod(seconds(out.time - all.clock.start), every) < knob("blink_length");
  out.valid = number >= 0 && !blinks && knob("gaze_valid") != 0 && knob("orientation") != 0;
  out.tracked = knob("gaze_tracked") != 0;
  const Pose head = head_at(out.time);
  double yaw = knob("look_yaw");
  if (all.profile.look == "sweep") yaw += 15 * std::sin(1.9 * seconds(out.time - all.clock.start));
  out.pose = head * Pose{turned(yaw, knob("look_pitch"), 0), {}};
  if (all.profile.look == "page" && shows_targets()) out.pose = aimed(head.p, target_at(out.time));
  return out;
}

void see_page(const std::vector<const XrCompositionLayerQuad*>& quads) {
  auto& page = runtime().page;
  if (quads.empty()) {
    page.reset();
    return;
  }
  const XrCompositionLayerQuad& quad = *quads.back();
  const XrTime since = page ? page->since : now();
  page = Page{runtime().spaces.at(number_of(quad.space)), from_xr(quad.pose),
              static_cast<double>(quad.size.width), static_cast<double>(quad.size.height), since};
}

}  // namespace simulated
