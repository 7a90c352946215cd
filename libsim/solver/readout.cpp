#include "libsim/solver/readout.hpp"

#include <algorithm>

#include "libsim/solver/account_keeper.hpp"
#include "libsim/solver/fluid_simulation.hpp"
#include "stats/base/error.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct PackForDrawing {
  const Vec4* position;
  Vec4* out;
  SIM_FN void operator()(int i) const {
    out[i] = with_w(xyz(position[i]), radius_per_support * position[i].w);
  }
};

/// Packs a foam particle for drawing. In the last quarter of a mean lifetime its volume decreases to 0 in
/// proportion to the remaining time.
struct PackFoam {
  const Vec4* place;
  float radius, fades_s;
  Vec4* out;
  SIM_FN void operator()(int slot) const {
    const Vec4 at = place[slot];
    const float left = at_most(at_least(at.w / fades_s, 0.0f), 1.0f);
    out[slot] = with_w(xyz(at), radius * cbrtf(left));
  }
};

PackFoam packing(const FluidState& state, const Vec4* place, Vec4* out) {
  const EffectCoefficients& e = state.parameters.effects;
  return {place, 0.5f * e[EffectOption::FoamDiameter], 0.25f * e[EffectOption::FoamLifetime], out};
}

}  // namespace

std::vector<float> field_of(const Particles& particles, ParticleField field) {
  const auto n = static_cast<std::size_t>(particles.size());
  std::vector<float> out(n, field == ParticleField::Active ? 1.0f : 0.0f);
  if (field == ParticleField::Speed) {
    const auto velocity = particles.all().velocity.to_host();
    for (std::size_t i = 0; i < n; ++i) out[i] = length(xyz(velocity[i]));
  } else if (field == ParticleField::DensityError && particles.has(Column::Density)) {
    const auto density = particles.all().density.to_host();
    for (std::size_t i = 0; i < n; ++i) out[i] = density[i] - 1;
  } else if (field == ParticleField::Active && particles.has(Column::Active)) {
    const auto active = particles.all().active.to_host();
    for (std::size_t i = 0; i < n; ++i) out[i] = active[i] != 0;
  } else if (field == ParticleField::Temperature && particles.has(Column::Temperature)) {
    out = particles.all().temperature.to_host();
  }
  return out;
}

void pack_saliency(const std::vector<float>& s, const std::vector<std::uint8_t>& target,
                   const std::vector<SaliencyParts>& parts, std::vector<ParticleSaliency>& out) {
  out.resize(s.size());
  for (std::size_t i = 0; i < s.size(); ++i) {
    const SaliencyParts p = parts.empty() ? SaliencyParts{} : parts[i];
    out[i] = {p.acuity, p.manifold, p.temporal, p.combined, s[i], target[i]};
  }
}

HeatReport heat_of(const FluidState& state) {
  HeatReport out;
  if (!state.particles.has(Column::Temperature)) return out;
  const auto temperature = state.particles.all().temperature.to_host();
  const auto level = state.particles.all().level.to_host();
  for (std::size_t i = 0; i < level.size(); ++i)
    out.held += static_cast<double>(temperature[i]) * static_cast<double>(1 << level[i]);
  const HeatLedger ledger = state.heat.to_host()[0];
  out.poured = HeatLedger::amount(ledger.poured);
  out.taken = HeatLedger::amount(ledger.taken);
  out.drained = HeatLedger::amount(ledger.drained);
  out.from_walls = HeatLedger::amount(ledger.walls);
  return out;
}

LevelEvents events_of(const LevelCounts& counts) {
  return {counts.splits,         counts.born,          counts.merges,
          counts.split_deferred, counts.split_at_wall, counts.split_no_room,
          counts.merge_overlap,  counts.merge_step,    1e-6 * static_cast<double>(counts.energy_lost_uj)};
}

SaliencyState observer_of(const Readings& readings, int levels) {
  SaliencyState out;
  out.readings = readings;
  out.levels = levels;
  return out;
}

PartTimes times_of(const PartClock& clock) {
  return {.saliency_ms = clock.milliseconds(Part::Saliency),
          .levels_ms = clock.milliseconds(Part::Levels),
          .activation_ms = clock.milliseconds(Part::Activation),
          .solve_ms = clock.milliseconds(Part::Solve)};
}

std::size_t bytes_of(const FluidState& state) {
  return state.particles.bytes() + state.jets.columns.bytes() + state.jets.exchange.bytes() +
         state.outflow.bytes() + state.saliency.bytes() + state.activation.bytes() + state.foam.bytes();
}

std::vector<float> radii_of(const LevelSupports& supports, std::pair<int, int> levels) {
  std::vector<float> out;
  for (int level = levels.first; level <= levels.second; ++level)
    out.push_back(radius_per_support * supports.h[level]);
  return out;
}

void check_live(const LiveNumbers& numbers) {
  if (!(numbers.alpha >= 0 && numbers.alpha <= 1))
    throw base::Error("alpha = " + std::to_string(numbers.alpha), "is out of range",
                      "use a weight from 0 to 1");
  if (numbers.iterations < 1 || numbers.iterations > LiveNumbers::most_iterations) {
    throw base::Error("iterations = " + std::to_string(numbers.iterations), "is out of range",
                      "use 1 to " + std::to_string(LiveNumbers::most_iterations) + " per substep");
  }
}

FrameReport report_of(const FluidState& state) {
  const Measured measured = measure(state);
  FrameReport out;
  out.particles = state.particles.size();
  for (const std::uint8_t level : state.particles.all().level.to_host()) {
    if (level >= out.particles_by_level.size()) out.particles_by_level.resize(level + std::size_t{1});
    ++out.particles_by_level[level];
    out.mass_units += std::int64_t{1} << level;
  }
  out.jump_share = measured.jump_share;
  out.density_error_mean = measured.density_error_mean;
  out.density_max = measured.density_max;
  out.neighbours_mean = measured.neighbours_mean;
  out.listed_mean = measured.listed_mean;
  out.speed_max_m_s = measured.speed_max_m_s;
  out.guards = guard_counts(state.guards.to_host()[0], state);
  out.poured = state.jets.poured;
  out.particles_in = state.jets.made;
  out.particles_out = state.jets.taken + state.drained.particles;
  out.drained = state.drained.mass;
  out.reservoir = state.jets.reservoir;
  out.heat = heat_of(state);
  out.seen = state.saliency.input.seen();
  out.foam = report_of(state.foam);
  return out;
}

std::vector<ParticleState> states_of(const Particles& particles) {
  const auto position = particles.all().position.to_host();
  const auto velocity = particles.all().velocity.to_host();
  const auto id = particles.all().id.to_host();
  const auto level = particles.all().level.to_host();
  std::vector<ParticleState> out(position.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = {id[i],         level[i],      position[i].x, position[i].y,
              position[i].z, velocity[i].x, velocity[i].y, velocity[i].z};
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return out;
}

void render_particles_of(const Particles& particles, std::vector<RenderParticle>& out) {
  out.resize(static_cast<std::size_t>(particles.size()));
  static_assert(sizeof(RenderParticle) == sizeof(Vec4));
  copy_to_host(out.data(), particles.all().position.data(), out.size() * sizeof(Vec4));
  for (auto& particle : out) particle.radius_m *= radius_per_support;
}

void pack_for_drawing(const Particles& particles, Vec4* out) {
  for_each("pack for drawing", particles.size(), PackForDrawing{particles.all().position.data(), out});
}

SurfaceParticles surface_particles_of(const FluidState& state, bool lid, int frame, bool turns) {
  const auto& p = state.particles.all();
  // From one turn of the levels to the next, in equal steps.
  const int left = state.saliency.readings.levels_period_frames + 1 - state.levels.turns.frames_since;
  return {.n = state.particles.size(),
          .position = p.position.data(),
          .velocity = p.velocity.data(),
          .id = turns ? p.id.data() : nullptr,
          .most_ids = state.particles.capacity(),
          .frame = frame,
          .follow = 1 / static_cast<float>(std::max(left, 1)),
          .frame_s = static_cast<float>(state.parameters.frame_s()),
          .support = state.one_level ? state.lightest_support : state.supports.h[1],
          .tank = state.domain,
          .lid = lid};
}

FoamReport report_of(const FoamPool& pool) {
  FoamReport out;
  if (pool.capacity() == 0) return out;
  const FoamLedger ledger = pool.ledger.to_host()[0];
  out.emitted = ledger.emitted;
  out.dissolved = ledger.dissolved;
  out.dropped = ledger.dropped;
  out.left = ledger.left;
  const auto place = pool.place.to_host();
  const auto velocity = pool.velocity.to_host();
  for (std::size_t slot = 0; slot < place.size(); ++slot) {
    if (!(place[slot].w > 0)) continue;
    const float water = velocity[slot].w;
    ++(water < FoamKinds::spray ? out.spray : water > FoamKinds::bubble ? out.bubbles : out.foam);
  }
  return out;
}

void pack_foam(const FluidState& state, Vec4* out) {
  for_each("pack foam", state.foam.capacity(), packing(state, state.foam.place.data(), out));
}

void render_foam_of(const FluidState& state, std::vector<RenderParticle>& out) {
  std::vector<Vec4> place = state.foam.place.to_host();
  const PackFoam pack = packing(state, place.data(), place.data());
  out.clear();
  for (int slot = 0; slot < state.foam.capacity(); ++slot) {
    pack(slot);
    const Vec4& at = place[static_cast<std::size_t>(slot)];
    if (at.w > 0) out.push_back({at.x, at.y, at.z, at.w});
  }
}

}  // namespace sim::SIM_BACKEND
