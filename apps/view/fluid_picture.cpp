#include "apps/view/fluid_picture.hpp"

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
}

}  // namespace apps
