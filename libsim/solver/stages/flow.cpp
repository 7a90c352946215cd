/// Water that nozzles pour and water that leaves through outlets.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

using NozzleColumns = ColumnView<columns(Column::Position, Column::Velocity, Column::Id, Column::Level),
                                 columns(Column::Position, Column::Velocity, Column::Id, Column::Level),
                                 columns(Column::Target), columns(Column::Temperature)>;

/// Places the particles of the layers that are due within the frame. A layer that passes the mouth `lead`
/// seconds after the frame's start begins the frame at the height u lead - g lead^2 / 2 above the mouth, with
/// the speed u - g lead, if gravity points down. It then falls freely and passes the mouth at the speed u.
struct Pour {
  const int* which;  ///< indices of the particles to place; nullptr: consecutive indices from `first`
  int first;
  Vec4* position;
  Vec4* velocity;
  Vec3 mouth;
  float radius, speed;
  Vec3 lift;  ///< minus the acceleration of gravity, m/s2
  int sites;
  double first_lead, interval;  // s
  double first_turn;            // full turns
  const std::uint8_t* level;
  float* temperature;
  float warmth;      ///< temperature of the jet, K above the reference
  HeatLedger* heat;  ///< nullptr if particles have no temperature

  SIM_FN void operator()(int k) const {
    const int site = k % sites;
    const int layer = k / sites;
    // The sites of a layer form Vogel's sunflower pattern (1979): each site is turned by the golden angle,
    // 0.382 turns, from the one before. Each layer is turned by 1 rad from the one before.
    constexpr double golden = 0.38196601125010515;
    constexpr double radian = 0.15915494309189535;
    const double turns = first_turn + layer * radian + site * golden;
    const float angle = 2 * pi * static_cast<float>(turns - floor(turns));
    const float r = radius * sqrtf((static_cast<float>(site) + 0.5f) / static_cast<float>(sites));
    const auto lead = static_cast<float>(first_lead + layer * interval);
    const float above = lead * (speed - 0.5f * lift.y * lead);
    const Vec3 aside{0.5f * lift.x * lead * lead, 0, 0.5f * lift.z * lead * lead};
    const int i = which ? which[k] : first + k;
    position[i] = with_w(mouth + Vec3{r * cosf(angle), above, r * sinf(angle)} - aside, position[i].w);
    velocity[i] = with_w(lead * lift - Vec3{0, speed, 0}, 0);
    if (heat) warm(i);
  }
  /// Sets the particle's temperature to the jet's. The heat of a reused particle is first counted as taken.
  SIM_FN void warm(int i) const {
    if (which) atomic_add(&heat->taken, HeatLedger::of(temperature[i], level[i]));
    temperature[i] = warmth;
    atomic_add(&heat->poured, HeatLedger::of(warmth, level[i]));
  }
};

float warmth_of(const Nozzle& nozzle, const SolverParameters& parameters) {
  const float reference = parameters.effects[EffectOption::HeatReference];
  return nozzle.temperature_k > 0 ? static_cast<float>(nozzle.temperature_k) - reference : 0;
}

void pour(FluidState& state, NozzleColumns p, const Nozzle& nozzle, const LayersDue& due, std::int64_t number,
          int sites, int layers, const int* which, int first) {
  const auto f = [](double value) { return static_cast<float>(value); };
  const double turns = static_cast<double>(number) / (2 * std::numbers::pi);
  for_each("pour", layers * sites,
           Pour{.which = which,
                .first = first,
                .position = p.position(),
                .velocity = p.velocity(),
                .mouth = {f(nozzle.position_m[0]), f(nozzle.position_m[1]), f(nozzle.position_m[2])},
                .radius = f(nozzle.diameter_m / 2),
                .speed = f(nozzle.speed_m_s),
                .lift = state.parameters.gravity.lift(),
                .sites = sites,
                .first_lead = due.first_time_s,
                .interval = due.interval_s,
                .first_turn = turns - std::floor(turns),
                .level = p.level(),
                .temperature = p.temperature(),
                .warmth = warmth_of(nozzle, state.parameters),
                .heat = state.heat.data()});
}

/// Sums the mass per target level within a sphere.
struct CountTargets {
  const Vec4* position;
  const std::uint8_t* level;
  const std::uint8_t* target;
  Vec3 centre;
  float radius;
  int* mass;
  SIM_FN void operator()(int i) const {
    const Vec3 offset = xyz(position[i]) - centre;
    if (!(dot(offset, offset) < radius * radius)) return;
    atomic_add(&mass[target[i] & 3], 1 << level[i]);
  }
};

/// Median target level, by mass, of the water within one diameter of the mouth; without water there, the
/// present Jets::level.
int median_target(FluidState& state, NozzleColumns p, const Nozzle& nozzle) {
  const auto f = [](double value) { return static_cast<float>(value); };
  Array<int>& mass = state.jets.mass_by_target;
  mass.resize(4);
  mass.zero();
  for_each("targets at nozzle", p.size(),
           CountTargets{.position = p.position(),
                        .level = p.level(),
                        .target = p.target(),
                        .centre = {f(nozzle.position_m[0]), f(nozzle.position_m[1]), f(nozzle.position_m[2])},
                        .radius = f(nozzle.diameter_m),
                        .mass = mass.data()});
  const auto sums = mass.to_host();
  const std::int64_t all = std::int64_t{sums[0]} + sums[1] + sums[2] + sums[3];
  if (all == 0) return state.jets.level;
  int level = 0;
  for (std::int64_t below = sums[0]; 2 * below < all; below += sums[static_cast<std::size_t>(level)]) ++level;
  return level;
}

/// Pours one nozzle's layers of this frame.
void pour_due_layers(FluidState& state, NozzleColumns p, const Nozzle& nozzle, Poured& before) {
  auto& jets = state.jets;
  const double frame_dt = jets.frame_dt_s;
  const auto spacing = [&] { return std::cbrt(1 << jets.level) * jets.finest_spacing_m; };
  if (layers_due(nozzle, spacing(), before, jets.frame, frame_dt).count == 0) return;
  if (jets.by_target) jets.level = median_target(state, p, nozzle);
  const LayersDue due = layers_due(nozzle, spacing(), before, jets.frame, frame_dt);
  const JetLayer layer = jet_layer(nozzle, spacing());
  const int found = jets.columns.find(p, jets.corners, state.parameters.gravity.up);
  int layers = 0;
  if (state.one_level) {
    layers = std::min(due.count, found / layer.sites);
    pour(state, p, nozzle, due, before.layers, layer.sites, layers, jets.columns.lowest_first(), 0);
    jets.taken += static_cast<std::int64_t>(layers) * layer.sites;
  } else {
    const int n = p.size();
    layers = jets.exchange.run(state.particles, state.supports, jets.columns.lowest_first(), found,
                               layer.sites, due.count, jets.level, jets.reservoir, state.heat.data());
    pour(state, p, nozzle, due, before.layers, layer.sites, layers, nullptr, p.size() - layers * layer.sites);
    jets.taken += n + layers * layer.sites - p.size();
  }
  jets.made += static_cast<std::int64_t>(layers) * layer.sites;
  state.lists_hold = state.lists_hold && layers == 0;
  jets.poured += static_cast<std::int64_t>(layers) * layer.sites << jets.level;
  jets.waited += static_cast<std::uint64_t>(due.count - layers);
  // Layers that could not be poured are dropped: `before` counts them too, so that no later frame pours them.
  before.length_m += due.count * layer.pitch_m;
  before.layers += due.count;
}

void run_nozzle(FluidState& state, NozzleColumns p) {
  auto& jets = state.jets;
  const std::int64_t made = jets.made;
  for (std::size_t k = 0; k < jets.nozzles.size(); ++k) {
    // If the jet has a constant level, the layers due so far follow from the frame number alone.
    if (!jets.by_target)
      jets.before[k] = poured_before(jets.nozzles[k], std::cbrt(1 << jets.level) * jets.finest_spacing_m,
                                     jets.frame, jets.frame_dt_s);
    pour_due_layers(state, p, jets.nozzles[k], jets.before[k]);
  }
  jets.pouring = jets.made > made;
}

}  // namespace

Stage nozzle_stage() {
  return stage_of<run_nozzle>({.name = "nozzle",
                               .source = "scenes: Vogel layers of the lowest corner water",
                               .phase = Phase::FrameStart,
                               .called_for = [](const Demand& demand) -> std::string {
                                 return demand.nozzles && !demand.settling ? "the scene has a nozzle" : "";
                               },
                               .changes = Change::Flow});
}

namespace {

void run_outflow(FluidState& state, OutflowView p) {
  const Outflow::Amount left = state.outflow.run(state.particles, p, state.walls, state.heat.data());
  if (left.particles == 0) return;
  state.drained.particles += left.particles;
  state.drained.mass += left.mass;
  state.mass_units -= left.mass;
  // Neighbour lists store particle indices, which have changed.
  state.lists_hold = false;
}

}  // namespace

Stage outflow_stage() {
  return stage_of<run_outflow>({.name = "outflow",
                                .source = "scenes: what is through an outlet leaves",
                                .phase = Phase::FrameEnd,
                                .called_for = [](const Demand& demand) -> std::string {
                                  return demand.outlets && !demand.settling ? "the scene has an outlet" : "";
                                },
                                .changes = Change::Flow});
}

}  // namespace sim::SIM_BACKEND
