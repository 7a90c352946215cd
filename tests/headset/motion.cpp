/// The scripted head motion.

#include "tests/headset/parts.hpp"

namespace simulated {

namespace {

double knob(const char* name) { return runtime().knobs.at(name); }
double wave(double hertz, XrTime time) {
  return std::sin(6.283185307179586 * hertz * 1e-9 * static_cast<double>(time - runtime().clock.start));
}

}  // namespace

Pose head_at(XrTime time) {
  const std::string& head = runtime().profile.head;
  Vector place{knob("x"), knob("y"), knob("z")};
  double yaw = knob("yaw"), pitch = knob("pitch");
  if (head != "still") {
    yaw += 25 * wave(0.2, time);
    pitch += 8 * wave(0.13, time);
  }
  if (head == "walk")
    place = place + Vector{0.4 * wave(0.1, time), 0.02 * wave(1.8, time), 0.3 * wave(0.07, time)};
  return {turned(yaw, pitch, knob("roll")), place};
}

Pose eye_at(XrTime time, int eye) {
  const double side = (eye == 0 ? -0.5 : 0.5) * knob("ipd");
  return head_at(time) * Pose{{}, {side, 0, 0}};
}

XrFovf fov_of(int eye) {
  const std::vector<double>& fov = runtime().profile.fov;
  const auto angle = [&](std::size_t i, double sign) {
    return static_cast<float>(sign * fov.at(i) * radians_per_degree);
  };
  if (eye == 0) return {angle(0, 1), angle(1, 1), angle(2, 1), angle(3, 1)};
  return {angle(1, -1), angle(0, -1), angle(2, 1), angle(3, 1)};
}

}  // namespace simulated
