#include "libsim/saliency/input.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "stats/base/error.hpp"

namespace sim::SIM_BACKEND {

namespace {

bool finite(const Mat4& m) {
  return std::all_of(m.begin(), m.end(), [](float value) { return std::isfinite(value); });
}

template <class Picture>
std::size_t pixels_of(const Picture& picture) {
  return static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
}

void check(const EyeLook& look) {
  const View& v = look.view;
  if (!finite(v.view) || !finite(v.projection)) {
    throw base::Error("Simulation::look", "the camera of an eye is not finite",
                      "give each eye a rigid view and a perspective");
  }
  if (!(look.visual_scale > 0) || !std::isfinite(look.visual_scale))
    throw base::Error(
        "Simulation::look",
        "the visual scale of an eye is " + std::to_string(look.visual_scale) + ", not a positive number",
        "give a visual scale above 0");
  const auto check_camera = [](const View& view) {
    if (!finite(view.view) || view.projection[0] == 0 || view.projection[5] == 0)
      throw base::Error("Simulation::look", "the camera of the G-buffer is not a perspective",
                        "draw the picture with a perspective");
  };
  if (look.shared) {
    const std::size_t pixels = pixels_of(*look.shared);
    if (pixels == 0 || look.shared->depth.bytes < 4 * pixels || look.shared->normal.bytes < 16 * pixels)
      throw base::Error("Simulation::look",
                        "the GL buffers of a picture of " + std::to_string(look.shared->width) + " x " +
                            std::to_string(look.shared->height) + " px have " +
                            std::to_string(look.shared->depth.bytes) + " bytes of depths and " +
                            std::to_string(look.shared->normal.bytes) + " bytes of normals",
                        "give at least 1 x 1 px, with 4 bytes of depth and 16 bytes of normal per px");
    check_camera(look.shared->view);
  }
  if (!look.seen || look.seen->width == 0) return;
  const GBuffer& g = *look.seen;
  const std::size_t pixels = pixels_of(g);
  if (g.depth.size() != pixels || g.normal.size() != 3 * pixels) {
    throw base::Error("Simulation::look",
                      "the G-buffer of " + std::to_string(g.width) + " x " + std::to_string(g.height) +
                          " px has " + std::to_string(g.depth.size()) + " depths and " +
                          std::to_string(g.normal.size()) + " components of normals",
                      "give one depth and three components of a normal per px");
  }
  check_camera(g.view);
}

/// Where an eye's picture comes from: GL's memory (Device), an array on the host, or no picture.
PictureWay way_of(const EyeLook& look) {
  if (look.shared) return PictureWay::Device;
  return look.seen && look.seen->width > 0 ? PictureWay::Host : PictureWay::None;
}

/// The unit direction, or 0 if the gaze is lost.
Vec3d direction_of(const Gaze& gaze) {
  const double size = std::hypot(gaze.direction[0], gaze.direction[1], gaze.direction[2]);
  const double place = gaze.origin_m[0] + gaze.origin_m[1] + gaze.origin_m[2];
  if (!gaze.valid || !std::isfinite(size) || !(size > 0) || !std::isfinite(place)) return {};
  return {gaze.direction[0] / size, gaze.direction[1] / size, gaze.direction[2] / size};
}

bool is_zero(const Vec3d& v) { return v[0] == 0 && v[1] == 0 && v[2] == 0; }

Vec3d axis_of(const View& view) {
  const Mat4 pose = rigid_inverse(view.view);
  return {-pose[8], -pose[9], -pose[10]};
}

Vec3d place_of(const View& view) {
  const Mat4 pose = rigid_inverse(view.view);
  return {pose[12], pose[13], pose[14]};
}

Vec3 narrow(const Vec3d& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

EyeSpace eye_space(const Mat4& m) {
  return {{m[0], m[4], m[8], m[12], m[1], m[5], m[9], m[13], m[2], m[6], m[10], m[14]}};
}

}  // namespace

void SaliencyInput::OneEye::take(const GBuffer& seen) {
  depth.from_host(seen.depth);
  normal.from_host(seen.normal);
  picture_view = seen.view;
  picture = {depth.data(), normal.data(), 3, seen.width, seen.height, seen.radius_scale};
}

/// Copies the picture, so that after give_back() GL may draw the next picture while the solver uses the copy.
/// The buffers stay mapped until give_back(): unmapping here would cost two more switches between GL and the
/// back end.
void SaliencyInput::OneEye::take(const GlPicture& shared) {
  depth.resize(pixels_of(shared));
  normal.resize(4 * pixels_of(shared));
  const auto& memory = sharing.map();
  copy_within(depth.data(), memory[0], depth.size() * sizeof(float));
  copy_within(normal.data(), memory[1], normal.size() * sizeof(float));
  picture_view = shared.view;
  picture = {depth.data(), normal.data(), 4, shared.width, shared.height, shared.radius_scale};
}

bool SaliencyInput::look(const Looks& looks, bool pictures) {
  if (looks.eyes.empty() || looks.eyes.size() > Eyes::most) {
    throw base::Error("Simulation::look", "has " + std::to_string(looks.eyes.size()) + " eyes",
                      "give one eye or two");
  }
  for (const auto& look : looks.eyes) check(look);
  for (std::size_t k = 0; k < looks.eyes.size() && pictures; ++k) {
    const GlPicture* shared = looks.eyes[k].shared;
    if (shared && !eyes_[k].sharing.accept({shared->depth, shared->normal})) return false;
  }
  // All buffers are mapped before the first copy, so that GL waits only once.
  for (std::size_t k = 0; k < looks.eyes.size() && pictures; ++k)
    if (looks.eyes[k].shared) eyes_[k].sharing.map();
  count_ = static_cast<int>(looks.eyes.size());
  if (pictures) seen_ = {};
  for (std::size_t k = 0; k < looks.eyes.size(); ++k) {
    const EyeLook& look = looks.eyes[k];
    OneEye& eye = eyes_[k];
    eye.gaze = look.gaze;
    eye.view = look.view;
    eye.visual_scale = look.visual_scale;
    if (!pictures) continue;
    eye.picture = {};
    const PictureWay way = way_of(look);
    if (way == PictureWay::None) continue;
    if (look.shared) {
      eye.take(*look.shared);
    } else {
      eye.take(*look.seen);
    }
    const bool first = seen_.way == PictureWay::None;
    seen_.frame = first ? look.seen_frame : std::min(seen_.frame, look.seen_frame);
    seen_.way = first ? way : std::max(seen_.way, way);
  }
  return true;
}

double SaliencyInput::OneEye::turned_deg(const Gaze& to, const View& by) const {
  constexpr double per_radian = 180 / std::numbers::pi;
  if (is_zero(marked)) return 180;
  Vec3d now = direction_of(to);
  const bool lost = is_zero(now);
  if (lost) {
    if (marked_valid) return 0;
    now = axis_of(by);
  }
  const Vec3d place = lost ? place_of(by) : to.origin_m;
  const double shift =
      std::hypot(place[0] - marked_place[0], place[1] - marked_place[1], place[2] - marked_place[2]);
  const double cosine = now[0] * marked[0] + now[1] * marked[1] + now[2] * marked[2];
  return per_radian * (std::acos(std::clamp(cosine, -1.0, 1.0)) + std::atan(shift));
}

double SaliencyInput::turned_deg(const Looks& looks) const {
  double most = 0;
  for (std::size_t k = 0; k < looks.eyes.size() && k < eyes_.size(); ++k)
    most = std::max(most, eyes_[k].turned_deg(looks.eyes[k].gaze, looks.eyes[k].view));
  return most;
}

double SaliencyInput::turned_deg() const {
  double most = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k)
    most = std::max(most, eyes_[k].turned_deg(eyes_[k].gaze, eyes_[k].view));
  return most;
}

void SaliencyInput::mark_gazes(double hold_s) {
  for (auto& eye : eyes_) {
    const Vec3d direction = direction_of(eye.gaze);
    const bool lost = is_zero(direction);
    if (lost && eye.marked_valid && eye.lost_s <= hold_s) continue;
    eye.marked_valid = !lost;
    eye.marked = lost ? axis_of(eye.view) : direction;
    eye.marked_place = lost ? place_of(eye.view) : eye.gaze.origin_m;
  }
}

void SaliencyInput::give_back() {
  for (auto& eye : eyes_) eye.sharing.unmap();
}

void SaliencyInput::look_by_default(const View& view) { look({{{{}, view, nullptr}}}); }

Eyes SaliencyInput::next_frame(double dt_s, double hold_s) {
  Eyes out;
  out.count = count_;
  for (int k = 0; k < count_; ++k) {
    OneEye& from = eyes_[static_cast<std::size_t>(k)];
    const Vec3d axis = axis_of(from.view);
    Vec3d origin = place_of(from.view);
    Vec3d direction = direction_of(from.gaze);
    if (is_zero(direction)) {
      ++gaze_lost_;
      from.lost_s += dt_s;
      const bool held = !is_zero(from.last_direction) && from.lost_s <= hold_s;
      direction = held ? from.last_direction : axis;
    } else {
      from.lost_s = 0;
      from.last_direction = direction;
      origin = from.gaze.origin_m;
    }
    Eye& eye = out.eye[k];
    eye.viewpoint = narrow(origin);
    eye.axis = narrow(axis);
    eye.visual_scale = static_cast<float>(from.visual_scale);
    eye.gaze = eye.visual(narrow(direction));
    eye.now = eye_space(from.view.view);
    eye.picture = from.picture;
    if (!from.picture.depth) continue;
    eye.then = eye_space(from.picture_view.view);
    eye.rays = pixel_rays(from.picture_view);
  }
  return out;
}

std::size_t SaliencyInput::bytes() const {
  std::size_t sum = 0;
  for (const auto& eye : eyes_) sum += eye.depth.bytes() + eye.normal.bytes();
  return sum;
}

}  // namespace sim::SIM_BACKEND
