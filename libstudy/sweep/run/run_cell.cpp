#include "libstudy/sweep/run/run_cell.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "libsim/gl/gl_context.hpp"
#include "libsim/gl/png.hpp"
#include "libsim/measure/checkpoint.hpp"
#include "libsim/measure/masks.hpp"
#include "libsim/measure/onlooker.hpp"
#include "libsim/measure/render_timer.hpp"
#include "libsim/measure/timed_run.hpp"
#include "libsim/methods/preset.hpp"
#include "libsim/scene/fill.hpp"
#include "libsim/scene/gaze.hpp"
#include "libsim/scene/scene.hpp"
#include "libsim/setting/finite_water.hpp"
#include "libsim/simulation.hpp"
#include "stats/base/picture_size.hpp"
#include "stats/base/timing.hpp"

namespace study {

namespace {

/// Draws pictures of the water for comparison, outside the timing.
class PictureKeeper {
 public:
  /// With `context_is_current`, draws in the current OpenGL context, which must outlive this object.
  /// Otherwise creates a context.
  PictureKeeper(const sim::Scene& scene, const base::PictureSize& size, bool context_is_current)
      : scene_(scene),
        context_(context_is_current ? std::nullopt : std::optional(sim::GlContext::make_headless())),
        eye_(scene, size) {}

  double pixels_per_degree() const { return std::numbers::pi / 180 / sim::pixel_rays(eye_.view()).scale_y; }
  /// Returns a picture of frame number `frame` of the run. With `masks`, adds the masks of the fovea around
  /// the gaze point (with the fovea's half angle in the solver's preset Tuned) and of the most salient part
  /// outside it. Computing masks reorders the particles.
  KeptPicture keep(sim::Simulation& fluid, int frame, double frame_dt_s, bool masks);

 private:
  const sim::Scene& scene_;
  std::optional<sim::GlContext> context_;  // declared before eye_, whose OpenGL objects need it
  measure::Onlooker eye_;
};

KeptPicture PictureKeeper::keep(sim::Simulation& fluid, int frame, double frame_dt_s, bool masks) {
  eye_.begin(nullptr);
  eye_.draw(fluid);
  KeptPicture out{.time_s = frame * frame_dt_s,
                  .png = sim::png_bytes(eye_.image(), "a picture of the sweep")};
  if (!masks) return out;
  const sim::GBuffer seen = eye_.gbuffer();
  const auto drawn_ids = fluid.read_ids();
  const sim::Vec3d point = sim::gaze_point(scene_, sim::scene_frame(scene_, frame, frame_dt_s));
  const sim::Gaze gaze = sim::gaze_at(eye_.camera(), point);
  const measure::Mask fovea =
      measure::fovea_mask(eye_.view(), gaze, sim::readings_of(sim::Preset::Tuned).fovea_half_angle_deg);
  std::vector<sim::ParticleSaliency> values;
  fluid.measure_saliency({{{gaze, eye_.view(), &seen}}}, values);
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

constexpr int samples_per_s = 30, warm_up_frames = 5;

std::unique_ptr<sim::Simulation> start(const SweepCell& cell, const sim::Scene& scene, sim::Backend backend) {
  auto options = sim::to_options(cell.setting, backend, static_cast<std::uint32_t>(cell.seed));
  auto fluid = measure::make_settled(scene, options);
  if (cell.seed == 1) return fluid;
  options.start = measure::perturbed(fluid->read_state(), cell.seed - 1);
  fluid.reset();
  return sim::make_simulation(scene, options);
}

/// True for samples 0 and 1 of every three: two successive samples form a pair of pictures.
bool keeps_picture(std::size_t sample) { return sample % 3 != 2; }

std::unique_ptr<measure::RenderTimer> pictures(const SweepCell& cell, const sim::Scene& scene) {
  if (cell.size.empty()) return nullptr;
  return std::make_unique<measure::RenderTimer>(sim::GlContext::make_headless(),
                                                sim::acting_scene(scene, cell.setting.method),
                                                base::parse_picture_size(cell.size), 1);
}

std::unique_ptr<PictureKeeper> kept_pictures(const SweepCell& cell, const sim::Scene& scene) {
  if (cell.kept.empty()) return nullptr;
  return std::make_unique<PictureKeeper>(scene, base::parse_picture_size(cell.kept, "--pictures"),
                                         !cell.size.empty());
}

bool is_reference(const sim::SolverSetting& setting) {
  return setting == reference_setting(setting.scene, std::llround(setting[sim::SolverKnob::Size]));
}

}  // namespace

WaterSample sample_of(double time_s, const std::vector<sim::ParticleState>& water) {
  WaterSample out{.time_s = time_s};
  double all = 0;
  std::vector<std::pair<float, double>> by_x;  // x, mass
  by_x.reserve(water.size());
  for (const auto& p : water) {
    const double mass = std::exp2(p.level);
    const double vx = p.vx_m_s, vy = p.vy_m_s, vz = p.vz_m_s;
    all += mass;
    out.centre_m[0] += mass * p.x_m;
    out.centre_m[1] += mass * p.y_m;
    out.centre_m[2] += mass * p.z_m;
    out.kinetic_j_kg += mass * (vx * vx + vy * vy + vz * vz) / 2;
    by_x.emplace_back(p.x_m, mass);
  }
  if (all == 0) return out;
  for (double& axis : out.centre_m) axis /= all;
  out.kinetic_j_kg /= all;
  std::sort(by_x.begin(), by_x.end());
  double behind = 0;
  for (const auto& [x, mass] : by_x) {
    behind += mass;
    out.front_m = x;
    if (behind >= 0.99 * all) break;
  }
  return out;
}

CellRun run_cell(const SweepCell& cell, const sim::Scene& scene, sim::Backend backend) {
  const auto pictures_of_cell = pictures(cell, scene);
  const auto keeper = kept_pictures(cell, scene);
  const auto fluid = start(cell, scene, backend);
  if (pictures_of_cell) pictures_of_cell->warm_up(*fluid);
  const int rate = static_cast<int>(cell.setting[sim::SolverKnob::Rate]);
  const int frames = std::max(1, static_cast<int>(std::lround(cell.seconds * rate)));
  CellRun out;
  if (keeper) out.pixels_per_degree = keeper->pixels_per_degree();
  measure::Substeps substeps;
  for (int frame = 1; frame <= frames; ++frame) {
    FrameCost cost;
    const double begin = base::milliseconds_now();
    if (pictures_of_cell && fluid->follows_picture()) pictures_of_cell->look(*fluid);
    fluid->step_frame();
    fluid->synchronize();
    cost.solve_ms = base::milliseconds_now() - begin;
    if (pictures_of_cell) {
      const auto times = pictures_of_cell->draw(*fluid);
      cost.draw_ms = times.transfer + times.render;
    }
    if (frame > warm_up_frames) out.frames.push_back(cost);
    substeps.add(fluid->substeps());
    out.particles_mean += static_cast<double>(fluid->particle_count()) / frames;
    if (frame * samples_per_s % rate != 0) continue;
    const std::size_t sample = out.samples.size();
    if (keeper && keeps_picture(sample)) {
      const bool masks = is_reference(cell.setting) && sample % 3 == 0;
      out.pictures.push_back(keeper->keep(*fluid, frame, 1.0 / rate, masks));
      // Draws the timed picture once more, without timing, so that the stored picture's OpenGL buffers are
      // not the last ones used before the next timed frame.
      if (pictures_of_cell) pictures_of_cell->draw(*fluid);
    }
    const auto report = fluid->report();
    out.samples.push_back(sample_of(static_cast<double>(frame) / rate, fluid->read_state()));
    out.samples.back().density_error = report.density_error_mean;
    out.samples.back().density_max = report.density_max;
    out.braked = static_cast<std::int64_t>(report.guards.speed_limited);
  }
  sim::check_finite(*fluid, to_text(cell));
  out.substeps_mean = substeps.mean(frames);
  return out;
}

}  // namespace study
