#include "libsim/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct Predict {
  Vec4* position;
  Vec4* velocity;
  Vec4* predicted;
  Walls walls;
  Vec3 refuge;
  Guards* guards;
  float gravity, dt, longest_step, wall_gap;

  SIM_FN void operator()(int i) const {
    const float h = position[i].w;
    Vec3 x = xyz(position[i]);
    Vec3 v = xyz(velocity[i]);
    quarantine(x, v);
    position[i] = with_w(x, h);
    v.y -= gravity * dt;
    v = limited(v, longest_step * h / dt, guards);
    velocity[i] = with_w(v, 0);
    x = fused(x, dt, v);
    if (walls.project(x, wall_gap * h / 2)) atomic_add(&guards->wall_projected, std::uint64_t{1});
    predicted[i] = with_w(x, h);
  }

  /// A broken velocity is lost; a broken position goes to the refuge. The rest of the fluid never reads
  /// either.
  SIM_FN void quarantine(Vec3& x, Vec3& v) const {
    const bool place_lost = !all_finite(x);
    if (!place_lost && all_finite(v)) return;
    atomic_add(&guards->not_finite, std::uint64_t{1});
    v = {0, 0, 0};
    if (place_lost) x = refuge;
  }
};

}  // namespace

Stage predict_stage() {
  return {"predict",
          "Macklin and Mueller 2013, Alg. 1 lines 1-4",
          Phase::Substep,
          columns(Column::Position, Column::Velocity),
          columns(Column::Predicted, Column::Position, Column::Velocity),
          [](const Demand&) -> std::string { return "every method moves its particles"; },
          [](FluidState& state) {
            auto& p = state.particles;
            const auto& k = state.parameters;
            for_each("predict", p.size(),
                     Predict{p.position.data(), p.velocity.data(), p.predicted.data(), state.walls,
                             state.refuge, state.guard(), k.gravity, k.dt, k.longest_step, k.wall_gap});
          }};
}

Stage neighbours_stage() {
  return {"neighbours",
          "compact grid and one combined list a substep",
          Phase::Substep,
          columns(Column::Predicted, Column::Position, Column::Velocity, Column::Id, Column::Level),
          columns(Column::Neighbours),
          [](const Demand&) -> std::string { return "the density constraint needs neighbours"; },
          [](FluidState& state) {
            auto* dropped = &state.guard()->neighbours_dropped;
            if (state.one_level) {
              state.grid.build(state.particles, NeighbourList::margin);
              state.neighbours.build(state.particles, state.grid, dropped);
            } else {
              state.grid.build(state.particles, NeighbourList::margin, state.supports);
              state.neighbours.build_mixed(state.particles, state.grid, dropped);
            }
          }};
}

}  // namespace sim::SIM_BACKEND
