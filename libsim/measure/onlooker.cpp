#include "libsim/measure/onlooker.hpp"

#include <cmath>

#include "stats/base/timing.hpp"

namespace measure {

Onlooker::Onlooker(const sim::Scene& scene, const base::PictureSize& size)
    : camera_(scene.view),
      view_(sim::make_view(scene.view, size.width, size.height)),
      target_(size.width, size.height),
      picture_(scene) {}

void Onlooker::step(sim::Simulation& fluid, const sim::Vec3d& gaze_m, bool wanted) {
  look(fluid, gaze_m);
  const double start = base::milliseconds_now();
  fluid.step_frame();
  if (wanted || fluid.needs_every_picture()) draw(fluid);
  fluid.synchronize();
  fluid.frame_time(base::milliseconds_now() - start);
}

std::vector<std::uint8_t> Onlooker::fluid_mask() const {
  const auto depth = picture_.renderer().read_depth();
  const auto width = static_cast<std::size_t>(target_.width());
  const auto height = static_cast<std::size_t>(target_.height());
  std::vector<std::uint8_t> out(depth.size());
  for (std::size_t y = 0; y < height; ++y) {
    // A G-buffer starts with its lowest row.
    for (std::size_t x = 0; x < width; ++x)
      out[y * width + x] = std::isfinite(depth[(height - 1 - y) * width + x]);
  }
  return out;
}

sim::Image Onlooker::painted_by_level(sim::Simulation& fluid, double finest_spacing_m) {
  std::vector<sim::RenderParticle> particles;
  fluid.read_particles(particles);
  std::vector<float> levels;
  for (const auto& p : particles) {
    // Eq. 10: r = cbrt(2^level) r_*
    levels.push_back(std::round(3 * std::log2(2 * p.radius_m / static_cast<float>(finest_spacing_m))));
  }
  sim::Overlay overlay;
  overlay.values = levels;
  overlay.classes = true;
  picture_.renderer().paint(overlay, target_.framebuffer());
  return target_.read();
}

}  // namespace measure
