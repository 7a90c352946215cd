#include "libstudy/sweep/run/picture_keeper.hpp"

#include <numbers>
#include <optional>

#include "libsim/measure/masks.hpp"
#include "libsim/measure/onlooker.hpp"
#include "libsim/methods/preset.hpp"
#include "libsim/render/gl_context.hpp"
#include "libsim/render/png.hpp"
#include "libsim/scene/gaze.hpp"

namespace study {

struct PictureKeeper::State {
  const sim::Scene& scene;
  std::optional<sim::GlContext> context;  // must outlive the objects drawn in it
  measure::Onlooker eye;

  State(const sim::Scene& of, const base::PictureSize& size, bool context_is_current)
      : scene(of),
        context(context_is_current ? std::nullopt : std::optional(sim::GlContext::make_headless())),
        eye(of, size) {}
};

PictureKeeper::PictureKeeper(const sim::Scene& scene, const base::PictureSize& size, bool context_is_current)
    : state_(std::make_unique<State>(scene, size, context_is_current)) {}

PictureKeeper::~PictureKeeper() = default;

double PictureKeeper::pixels_per_degree() const {
  return std::numbers::pi / 180 / sim::pixel_rays(state_->eye.view()).scale_y;
}

KeptPicture PictureKeeper::keep(sim::Simulation& fluid, int frame, double frame_dt_s, bool masks) {
  auto& eye = state_->eye;
  eye.begin(nullptr);
  eye.draw(fluid);
  KeptPicture out{.time_s = frame * frame_dt_s, .png = sim::png_bytes(eye.image(), "a picture of the sweep")};
  if (!masks) return out;
  const sim::GBuffer seen = eye.gbuffer();
  const auto drawn_ids = fluid.read_ids();
  const sim::Vec3d point = sim::gaze_point(state_->scene, sim::scene_frame(state_->scene, frame, frame_dt_s));
  const sim::Gaze gaze = sim::gaze_at(eye.camera(), point);
  const measure::Mask fovea =
      measure::fovea_mask(eye.view(), gaze, sim::readings_of(sim::Preset::Tuned).fovea_half_angle_deg);
  std::vector<sim::ParticleSaliency> values;
  fluid.measure_saliency({{{gaze, eye.view(), &seen}}}, values);
  const auto ids = fluid.read_ids();
  std::vector<float> by_id;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto id = static_cast<std::size_t>(ids[i]);
    if (id >= by_id.size()) by_id.resize(id + 1);
    by_id[id] = values[i].combined;
  }
  out.fovea = to_bits(fovea);
  out.salient = to_bits(measure::salient_mask(seen, drawn_ids, by_id, fovea));
  return out;
}

}  // namespace study
