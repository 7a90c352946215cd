/// What scene, method and readings mean for each part of the solver.

#include <algorithm>

#include "libsim/scene/fill.hpp"
#include "libsim/solver/fluid_simulation.hpp"
#include "stats/base/error.hpp"

namespace sim::SIM_BACKEND {

SolverParameters solver_parameters(const Scene& scene, const SimulationOptions& options) {
  SolverParameters out;
  const double frame_dt = options.frame_dt_s > 0 ? options.frame_dt_s : scene.frame_dt_s;
  out.substeps = options.substeps > 0 ? options.substeps : substeps_of(scene, options.n_star);
  out.iterations = options.iterations > 0 ? options.iterations : scene.solver_iterations;
  out.dt = static_cast<float>(frame_dt / out.substeps);
  out.gravity = static_cast<float>(scene.gravity_m_s2);
  const auto choose = [](float& number, double wish) {
    if (wish >= 0) number = static_cast<float>(wish);
  };
  choose(out.relaxation, options.relaxation);
  choose(out.tensile, options.tensile);
  choose(out.viscosity, options.viscosity);
  choose(out.momentum, options.momentum);
  if (options.coarse_cycles >= 0) out.coarse_cycles = options.coarse_cycles;
  choose(out.coarse_edge, options.coarse_edge);
  choose(out.longest_step, options.longest_step);
  return out;
}

Demand demand_of(const Scene& scene, const SimulationOptions& options, const SolverParameters& parameters) {
  const MethodTraits& method = traits_of(options.method);
  Demand out;
  out.parameters = parameters;
  out.nozzles = !scene.nozzles.empty();
  out.levels = method.adaptive();
  out.forced_targets = options.forced_targets.has_value();
  out.gaze_targets = method.target == TargetSource::Gaze && !out.forced_targets;
  out.saliency = method.target == TargetSource::Saliency && !out.forced_targets;
  out.saliency_parts = options.saliency_parts;
  out.activation = method.temporal || options.temporal.always;
  return out;
}

TargetSphere sphere_of(const TargetRegion& region) {
  if (std::min(region.inside, region.outside) < 0 || std::max(region.inside, region.outside) >= most_levels) {
    throw base::Error("forced targets", "name a level that does not exist", "use levels 0 to 3");
  }
  const auto f = [](double value) { return static_cast<float>(value); };
  return {{f(region.centre_m[0]), f(region.centre_m[1]), f(region.centre_m[2])},
          f(region.radius_m),
          region.inside,
          region.outside};
}

Walls walls_of(const Scene& scene, bool gate_closed) {
  Vec3d low{0, 0, 0};
  Vec3d high = scene.tank_size_m;
  if (gate_closed) {
    low = scene.fill_min_m;
    high = scene.fill_max_m;
  }
  const auto f = [](double value) { return static_cast<float>(value); };
  Walls out{};
  out.planes[out.count++] = {{1, 0, 0}, f(low[0])};
  out.planes[out.count++] = {{-1, 0, 0}, f(-high[0])};
  out.planes[out.count++] = {{0, 0, 1}, f(low[2])};
  out.planes[out.count++] = {{0, 0, -1}, f(-high[2])};
  out.planes[out.count++] = {{0, 1, 0}, f(low[1])};
  return out;
}

}  // namespace sim::SIM_BACKEND
