#include "libsim/render/fluid_picture.hpp"

namespace sim {

void FluidPicture::take(Simulation& fluid) {
  uploaded_ = surface_ == Surface::Ellipsoids ? !take_surface(fluid) : !take_particles(fluid);
  if (uploaded_) buffer_.upload(particles_, shapes_);
  take_foam(fluid);
  taken_frame_ = fluid.frame();
  renderer_.place_obstacles(fluid.read_obstacles());
}

bool FluidPicture::take_particles(Simulation& fluid) {
  buffer_.reserve(fluid.particle_capacity());
  if (fluid.copy_to_gl(buffer_.gl())) {
    buffer_.set_count(fluid.particle_count());
    return true;
  }
  fluid.read_particles(particles_);
  shapes_.clear();
  return false;
}

bool FluidPicture::take_surface(Simulation& fluid) {
  buffer_.reserve_with_shapes(fluid.particle_capacity());
  if (const auto written = fluid.copy_surface_to_gl(buffer_.gl(), buffer_.shapes())) {
    buffer_.set_count(*written);
    return true;
  }
  fluid.read_surface(particles_, shapes_);
  return false;
}

void FluidPicture::take_foam(Simulation& fluid) {
  if (fluid.foam_capacity() == 0) return foam_.set_count(0);
  foam_.reserve(fluid.foam_capacity());
  if (fluid.copy_foam_to_gl(foam_.gl())) {
    foam_.set_count(fluid.foam_capacity());
  } else {
    fluid.read_foam(particles_);
    foam_.upload(particles_);
  }
}

void FluidPicture::show(std::span<const View> views, unsigned framebuffer) {
  renderer_.draw(buffer_, views, framebuffer, &foam_);
  drawn_frame_ = taken_frame_;
}

void FluidPicture::begin(const GBuffer* seen) {
  before_ = seen;
  drawn_frame_.reset();
}

void FluidPicture::look(Simulation& fluid, const View& view, const Gaze& gaze, double visual_scale) {
  EyeLook eye{gaze, view};
  eye.visual_scale = visual_scale;
  if (!drawn_frame_ || !fluid.follows_picture()) {
    eye.seen = before_;
    fluid.look({{eye}});
    return;
  }
  eye.seen_frame = *drawn_frame_;
  const GlPicture shared = renderer_.picture();
  eye.shared = &shared;
  if (fluid.look({{eye}})) return;
  renderer_.read_picture(seen_);
  eye.shared = nullptr;
  eye.seen = &seen_;
  fluid.look({{eye}});
}

std::string in_words(const SeenReport& seen) {
  if (seen.way == PictureWay::None) return "no picture";
  return "picture of frame " + std::to_string(seen.frame) + " by way of " + picture_way_name(seen.way);
}

std::string picture_way_name(PictureWay way) {
  switch (way) {
    case PictureWay::Device:
      return "device";
    case PictureWay::Host:
      return "host";
    default:
      return "none";
  }
}

Gaze gaze_at(const Camera& camera, const Vec3d& point_m) {
  Gaze gaze;
  gaze.origin_m = camera.eye_m;
  for (std::size_t k = 0; k < 3; ++k) gaze.direction[k] = point_m[k] - camera.eye_m[k];
  gaze.valid = true;
  return gaze;
}

Gaze gaze_through(const View& view, double x_px, double y_px) {
  const PixelRays rays = pixel_rays(view);
  const Mat4 to_world = rigid_inverse(view.view);
  const double slope[3] = {x_px * static_cast<double>(rays.scale_x) + static_cast<double>(rays.offset_x),
                           y_px * static_cast<double>(rays.scale_y) + static_cast<double>(rays.offset_y), -1};
  Gaze gaze;
  for (std::size_t row = 0; row < 3; ++row) {
    gaze.origin_m[row] = static_cast<double>(to_world[12 + row]);
    for (std::size_t column = 0; column < 3; ++column) {
      gaze.direction[row] += static_cast<double>(to_world[4 * column + row]) * slope[column];
    }
  }
  gaze.valid = true;
  return gaze;
}

}  // namespace sim
