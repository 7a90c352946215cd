#include "apps/common/fluid_picture.hpp"

namespace apps {

void FluidPicture::draw(sim::Simulation& fluid, const sim::View& view, unsigned framebuffer) {
  buffer_.reserve(fluid.particle_count());
  uploaded_ = !fluid.copy_to_gl(buffer_.gl_name());
  if (uploaded_) {
    fluid.read_particles(particles_);
    buffer_.upload(particles_);
  } else {
    buffer_.set_count(fluid.particle_count());
  }
  renderer_.draw(buffer_, {&view, 1}, framebuffer);
  drawn_ = true;
}

void FluidPicture::look(sim::Simulation& fluid, const sim::View& view, const sim::Gaze& gaze) {
  if (drawn_) seen_ = renderer_.read_gbuffer();
  fluid.look({{{gaze, view, drawn_ ? &seen_ : nullptr}}});
}

sim::Gaze gaze_at(const sim::Camera& camera, const sim::Vec3d& point_m) {
  sim::Gaze gaze;
  gaze.origin_m = camera.eye_m;
  for (std::size_t k = 0; k < 3; ++k) gaze.direction[k] = point_m[k] - camera.eye_m[k];
  gaze.valid = true;
  return gaze;
}

}  // namespace apps
