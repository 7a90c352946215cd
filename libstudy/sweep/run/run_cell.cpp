#include "libstudy/sweep/run/run_cell.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "libsim/measure/checkpoint.hpp"
#include "libsim/measure/render_timer.hpp"
#include "libsim/measure/timed_run.hpp"
#include "libsim/setting/finite_water.hpp"
#include "libstudy/sweep/run/picture_keeper.hpp"
#include "stats/base/timing.hpp"

namespace study {

namespace {

constexpr int samples_per_s = 30, warm_up_frames = 5;

std::unique_ptr<sim::Simulation> start(const SweepCell& cell, const sim::Scene& scene, sim::Backend backend) {
  auto options = sim::to_options(cell.setting, backend, static_cast<std::uint32_t>(cell.seed));
  auto fluid = measure::make_settled(scene, options);
  if (cell.seed == 1) return fluid;
  options.start = measure::perturbed(fluid->read_state(), cell.seed - 1);
  fluid.reset();
  return sim::make_simulation(scene, options);
}

/// True for two of three samples: pairs of successive ones.
bool keeps_picture(std::size_t sample) { return sample % 3 != 2; }

std::unique_ptr<measure::RenderTimer> pictures(const SweepCell& cell, const sim::Scene& scene) {
  if (cell.size.empty()) return nullptr;
  return std::make_unique<measure::RenderTimer>(sim::GlContext::make_headless(), scene,
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
      // The timed picture's GL buffers are used again before the next timed frame.
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
