#include <algorithm>
#include <cmath>
#include <limits>

#include "libsim/scene/fill.hpp"
#include "libsim/solver/fluid_simulation.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Maximum mean compression of a start that needs no further projection. The coarse pressure turns remaining
/// compression into speed: at 1 % the surface of SingleDam at n_* = 32k had dents five frames later, and
/// ejected lumps after fifteen.
constexpr double enough = 0.002;

/// Compression of each particle, max(rho / rho_0 - 1, 0), weighted by mass. In an unweighted mean, many fine
/// particles would outweigh coarse water that is still compressed.
struct Excess {
  const float* density;
  const std::uint8_t* level;
  float* excess;
  float* mass;
  SIM_FN void operator()(int i) const {
    mass[i] = static_cast<float>(1 << level[i]);
    excess[i] = mass[i] * at_least(density[i] - 1, 0.0f);
  }
};

using RelaxingView = ColumnView<columns(Column::Position, Column::Velocity, Column::Id, Column::Level),
                                columns(Column::Position, Column::Predicted, Column::PredictedNext,
                                        Column::Neighbours, Column::Lambda, Column::Density)>;

double mean_compression(FluidState& state, RelaxingView p, Array<float>& excess, Array<float>& mass) {
  p.copy<Column::Predicted, Column::Position>();
  find_neighbours(state, p);
  if (state.neighbours.grow()) find_neighbours(state, p);
  constrain_density(state, p);
  for_each("start compression", p.size(), Excess{p.density(), p.level(), excess.data(), mass.data()});
  return fixed_order_sum(excess, p.size()) / fixed_order_sum(mass, p.size());
}

}  // namespace

std::vector<ParticleState> filled(const Scene& scene, const SimulationOptions& options, int level) {
  std::vector<ParticleState> out;
  for (const auto& point : fill_positions(scene, options.method, options.n_star)) {
    ParticleState particle;
    particle.id = static_cast<int>(out.size());
    particle.level = level;
    particle.x_m = static_cast<float>(point[0]);
    particle.y_m = static_cast<float>(point[1]);
    particle.z_m = static_cast<float>(point[2]);
    out.push_back(particle);
  }
  return out;
}

void check_start(const std::vector<ParticleState>& start, int capacity, bool adaptive) {
  std::vector<bool> taken(adaptive ? static_cast<std::size_t>(capacity) : 0);
  for (const auto& particle : start) {
    const std::string who = "start, particle " + std::to_string(particle.id);
    if (particle.level < 0 || particle.level >= most_levels) {
      throw base::Error(who, "has level " + std::to_string(particle.level) + ", which does not exist",
                        "use levels 0 to 3");
    }
    if (adaptive && (particle.id < 0 || particle.id >= capacity)) {
      throw base::Error(who, "has an id outside 0 .. " + std::to_string(capacity - 1),
                        "give ids from 0 on, or set a larger particle_capacity");
    }
    if (!adaptive) continue;
    const auto id = static_cast<std::size_t>(particle.id);
    if (taken[id])
      throw base::Error(who, "has the same id as another particle", "give each particle another id");
    taken[id] = true;
  }
}

std::pair<int, int> levels_at_start(const Scene& scene, const SimulationOptions& options) {
  const MethodTraits& method = traits_of(options.method);
  std::pair<int, int> out{method.start_level, method.start_level};
  if (options.start && !options.start->empty()) {
    const auto [least, most] =
        std::minmax_element(options.start->begin(), options.start->end(),
                            [](const auto& a, const auto& b) { return a.level < b.level; });
    out = {least->level, most->level};
  }
  if (method.adaptive()) return {0, std::max(out.second, options.levels - 1)};
  // If all particles have one level, nozzles reuse them. With mixed levels, nozzles create particles of the
  // method's start level.
  if (scene.nozzles.empty() || out.first == out.second) return out;
  return {std::min(out.first, method.start_level), std::max(out.second, method.start_level)};
}

void put_in(FluidState& state, const std::vector<ParticleState>& start) {
  std::vector<Vec4> position;
  std::vector<Vec4> velocity;
  std::vector<int> id;
  std::vector<std::uint8_t> level;
  state.mass_units = 0;
  for (const auto& particle : start) {
    state.mass_units += std::int64_t{1} << particle.level;
    const float h = state.supports.h[particle.level];
    position.push_back({particle.x_m, particle.y_m, particle.z_m, h});
    velocity.push_back({particle.vx_m_s, particle.vy_m_s, particle.vz_m_s, 0});
    id.push_back(particle.id);
    level.push_back(static_cast<std::uint8_t>(particle.level));
  }
  auto& p = state.particles.all();
  p.position.from_host(position);
  p.velocity.from_host(velocity);
  p.id.from_host(id);
  p.level.from_host(level);
  state.particles.begin_descents();
  if (state.particles.has(Column::Saliency)) p.saliency.zero();
  if (state.particles.has(Column::Drift)) {
    for (Vec4& v : velocity) v.w = dot(xyz(v), xyz(v));
    p.drift.from_host(velocity);
  }
  if (state.particles.has(Column::Unrest)) {
    p.unrest.from_host(std::vector<float>(start.size(), std::numeric_limits<float>::quiet_NaN()));
  }
}

void warm_up(FluidState& state, const Scene& scene) {
  if (!state.particles.has(Column::Temperature)) return;
  state.heat.resize(1);
  state.heat.zero();
  auto& p = state.particles.all();
  std::vector<float> temperature(static_cast<std::size_t>(state.particles.size()));
  const auto position = p.position.to_host();
  for (std::size_t i = 0; i < temperature.size(); ++i) {
    const Vec3d at{static_cast<double>(position[i].x), static_cast<double>(position[i].y),
                   static_cast<double>(position[i].z)};
    for (const WarmBox& box : scene.warm) {
      bool inside = true;
      for (std::size_t k = 0; k < 3; ++k) inside = inside && at[k] >= box.min_m[k] && at[k] < box.max_m[k];
      if (inside) temperature[i] = static_cast<float>(box.temperature_k - reference_temperature(scene));
    }
  }
  p.temperature.from_host(temperature);
}

void put_again(FluidState& state, const std::vector<ParticleState>& particles) {
  auto& p = state.particles.all();
  const std::vector<int> ids = p.id.to_host();
  std::vector<Vec4> position = p.position.to_host();
  std::vector<Vec4> velocity = p.velocity.to_host();
  for (const auto& particle : particles) {
    const auto found = std::find(ids.begin(), ids.end(), particle.id);
    if (found == ids.end())
      throw base::Error("particle " + std::to_string(particle.id), "does not exist",
                        "use an id that read_ids returns");
    const auto i = static_cast<std::size_t>(found - ids.begin());
    position[i] = {particle.x_m, particle.y_m, particle.z_m, position[i].w};
    velocity[i] = {particle.vx_m_s, particle.vy_m_s, particle.vz_m_s, 0};
  }
  p.position.from_host(position);
  p.velocity.from_host(velocity);
}

void begin_jets(FluidState& state, const Scene& scene, const SimulationOptions& options,
                const Resolution& resolution, int frame) {
  const auto f = [](double value) { return static_cast<float>(value); };
  auto& jets = state.jets;
  jets.finest_spacing_m = resolution.finest_spacing_m;
  jets.frame_dt_s = frame_dt_of(scene, options);
  jets.nozzles = scene.nozzles;
  for (const Nozzle& nozzle : scene.nozzles)
    if (const double beyond = beyond_lid_m(scene, nozzle, jets.frame_dt_s); beyond > 0)
      throw base::Error("scene " + scene.name + ", nozzle.position_m", nozzle_at_lid,
                        "take shorter frames, or lower the nozzle by " + base::shortest(beyond) + " m");
  for (Nozzle& nozzle : jets.nozzles) {
    // A scene gives pulses in frames of its frame time. They are converted, so that a pulse lasts equally
    // long in a run with another frame time.
    const auto in_the_run = [&](int frames) {
      return static_cast<int>(std::lround(frames * scene.frame_dt_s / jets.frame_dt_s));
    };
    nozzle.on_frames = std::max(1, in_the_run(nozzle.on_frames));
    nozzle.off_frames = in_the_run(nozzle.off_frames);
  }
  jets.level = resolution.level;
  jets.by_target = state.particles.has(Column::Target);
  jets.before.clear();
  for (const auto& nozzle : jets.nozzles)
    jets.before.push_back(poured_before(nozzle, resolution.spacing_m, frame, jets.frame_dt_s));
  jets.corners = {
      {0, 0, 0}, {f(scene.tank_size_m[0]), 0, f(scene.tank_size_m[2])}, f(scene.recirculation_corner_m)};
}

namespace {

/// Edge, m, of the cells in which foam's closing speeds are measured: the length that the effect's options
/// give, or by default a sixth of the cube root of the water's volume. At least 1.5 spacings of the coarsest
/// particles that a method may have at this n_* (the number of particles if all have the coarsest level), and
/// large enough that the tank has at most MeetingCells::most_cells cells.
float foam_length(const FluidState& state, const EffectCoefficients& e, const Scene& scene) {
  const float asked = e[EffectOption::FoamLength];
  const float wish = std::max(asked > 0 ? asked : static_cast<float>(std::cbrt(water_volume_m3(scene)) / 6),
                              0.75f * state.supports.h[most_levels - 1]);
  return MeetingCells::edge_of(state.domain, wish);
}

void lay_foam_cells(FluidState& state, const Scene& scene) {
  state.foam.cells.lay(state.domain, foam_length(state, state.parameters.effects, scene),
                       state.finest_support);
}

}  // namespace

void check_foam(const FluidState& state, const EffectCoefficients& e, const Scene& scene, double frame_dt_s) {
  const double diameter = static_cast<double>(e[EffectOption::FoamDiameter]);
  const Vec3d& tank = scene.tank_size_m;
  // Upper bound of the foam particles per frame: the tank is full of water, and everywhere the potentials of
  // approach and crest are at their maximum.
  const auto crest = static_cast<double>(e[EffectOption::FoamCrestWeight] * foam_length(state, e, scene) /
                                         state.supports.h[0]);
  const double most = (1 + 2 * crest) * static_cast<double>(e[EffectKind::Foam]) * frame_dt_s * tank[0] *
                      tank[1] * tank[2] / (0.52 * diameter * diameter * diameter);
  if (most > std::numeric_limits<int>::max()) {
    throw base::Error("effect foam",
                      "its particles of diameter_m = " + base::shortest(diameter) +
                          " are too small: a frame may create " + base::shortest(std::ceil(most)) +
                          " of them, and at most " + std::to_string(std::numeric_limits<int>::max()) +
                          " can be counted",
                      "raise diameter_m, or lower emission_per_s");
  }
}

void begin_foam(FluidState& state, const Scene& scene) {
  const EffectCoefficients& e = state.parameters.effects;
  state.foam.begin(static_cast<int>(e[EffectOption::FoamMost]), state.particles.capacity());
  lay_foam_cells(state, scene);
}

void exchange_effects(FluidState& state, const Scene& scene, ColumnSet columns) {
  const EffectCoefficients& e = state.parameters.effects;
  const bool was_warm = state.particles.has(Column::Temperature);
  state.particles.change_columns(columns);
  const bool warm = state.particles.has(Column::Temperature);
  if (warm && !was_warm) warm_up(state, scene);
  if (!warm) {
    state.heat = {};
    state.buoyancy = {};
  }
  if (!(e[EffectKind::Viscosity] > 0)) {
    state.conjugate_gradient = {};
    state.obstacles.rows = {};
  }
  if (!(e[EffectKind::Foam] > 0)) {
    state.foam = {};
  } else if (state.foam.capacity() != static_cast<int>(e[EffectOption::FoamMost])) {
    begin_foam(state, scene);
  } else {
    lay_foam_cells(state, scene);
  }
}

void settle(FluidState& state, const Scene& scene, const SimulationOptions& options) {
  // Levels and activation are off until the water rests.
  Demand demand;
  demand.parameters = state.parameters;
  demand.settling = true;
  demand.rests_by_drift = state.one_level_rests_by_drift;
  state.one_level = true;
  const Schedule settling = compile_schedule(demand);
  state.walls = walls_of(scene, true);
  for (int frame = 0; frame < scene.settle_frames; ++frame) {
    run_frame(settling, state);
    state.neighbours.grow();
    if (options.settling) options.settling(frame + 1, scene.settle_frames);
  }
  state.walls = walls_of(scene, false);
  state.lists_hold = false;
  if (const auto lost = state.guards.to_host()[0].not_finite; lost > 0) {
    throw base::Error(
        "scene " + scene.name + ", settling",
        std::to_string(lost) + " times a particle was not finite or far outside the tank",
        "use shorter frames (a higher frames_per_s in the scene), more substeps (min_substeps), or the "
        "solver's default numbers");
  }
  // Other guard events while settling are not part of the run.
  state.guards.zero();
}

RelaxedStart relax_start(FluidState& state, int most) {
  const RelaxingView p(state.particles);
  RelaxedStart out;
  if (p.size() == 0) return out;
  Array<float> excess(static_cast<std::size_t>(p.size()));
  Array<float> mass(static_cast<std::size_t>(p.size()));
  state.iteration = 0;  // displace() adds its momentum term from iteration 1 on
  for (;; ++out.projections) {
    out.compression = mean_compression(state, p, excess, mass);
    if (out.compression < enough || out.projections == most) return out;
    displace(state, p);
    p.copy<Column::Position, Column::Predicted>();
  }
}

void start_velocity_grid(FluidState& state) {
  state.activation.beta = 1;
  activation_stage().run(state);
  velocity_grid_stage().run(state);
}

RelaxedStart prepare_start(FluidState& state, int most) {
  const RelaxedStart out = relax_start(state, most);
  if (state.particles.has(Column::Active)) start_velocity_grid(state);
  // Guard events of this phase are not part of the run.
  state.guards.zero();
  return out;
}

}  // namespace sim::SIM_BACKEND
