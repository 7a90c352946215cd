#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Moves particles into the layers whose turn comes within the frame. A layer that passes the mouth `lead`
/// seconds after the frame's start begins it u lead - g lead^2 / 2 above the mouth at the speed u - g lead.
struct Pour {
  const int* taken;
  Vec4* position;
  Vec4* velocity;
  Vec3 mouth;
  float radius, speed, gravity;
  int sites;
  double first_lead, interval;  // s
  double first_turn;            // full turns

  SIM_FN void operator()(int k) const {
    const int site = k % sites;
    const int layer = k / sites;
    // Vogel 1979: sunflower sites, each layer turned by 1 rad.
    constexpr double golden = 0.38196601125010515;
    constexpr double radian = 0.15915494309189535;
    const double turns = first_turn + layer * radian + site * golden;
    const float angle = 2 * pi * static_cast<float>(turns - floor(turns));
    const float r = radius * sqrtf((static_cast<float>(site) + 0.5f) / static_cast<float>(sites));
    const auto lead = static_cast<float>(first_lead + layer * interval);
    const float above = lead * (speed - 0.5f * gravity * lead);
    const int i = taken[k];
    position[i] = with_w(mouth + Vec3{r * cosf(angle), above, r * sinf(angle)}, position[i].w);
    velocity[i] = {0, gravity * lead - speed, 0, 0};
  }
};

void pour(FluidState& state, const Nozzle& nozzle, const LayersDue& due, const int* taken, int layers) {
  auto& p = state.particles;
  const auto f = [](double value) { return static_cast<float>(value); };
  const int sites = jet_layer(nozzle, state.jets.spacing_m).sites;
  const double turns = static_cast<double>(due.first) / (2 * std::numbers::pi);
  for_each("pour", layers * sites,
           Pour{taken,
                p.position.data(),
                p.velocity.data(),
                {f(nozzle.position_m[0]), f(nozzle.position_m[1]), f(nozzle.position_m[2])},
                f(nozzle.diameter_m / 2),
                f(nozzle.speed_m_s),
                state.parameters.gravity,
                sites,
                due.first_time_s,
                due.interval_s,
                turns - std::floor(turns)});
}

void run(FluidState& state) {
  auto& jets = state.jets;
  std::vector<LayersDue> due;
  for (const auto& nozzle : jets.nozzles)
    due.push_back(layers_due(nozzle, jets.spacing_m, jets.frame, jets.frame_dt_s));
  if (std::all_of(due.begin(), due.end(), [](const LayersDue& one) { return one.count == 0; })) return;
  const int found = jets.columns.find(state.particles, jets.corners);
  int taken = 0;
  for (std::size_t k = 0; k < due.size(); ++k) {
    const int sites = jet_layer(jets.nozzles[k], jets.spacing_m).sites;
    const int layers = std::min(due[k].count, (found - taken) / sites);
    pour(state, jets.nozzles[k], due[k], jets.columns.lowest_first() + taken, layers);
    taken += layers * sites;
    jets.waited += static_cast<std::uint64_t>(due[k].count - layers);
  }
  jets.poured += static_cast<std::uint64_t>(taken);
}

}  // namespace

Stage nozzle_stage() {
  return {"nozzle",
          "scenes: Vogel layers of the lowest corner water",
          Phase::FrameStart,
          columns(Column::Position, Column::Velocity, Column::Id),
          columns(Column::Position, Column::Velocity),
          [](const Demand& demand) -> std::string {
            return demand.nozzles && !demand.settling ? "the scene has a nozzle" : "";
          },
          run};
}

}  // namespace sim::SIM_BACKEND
