#include "libsim/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// A particle that is not solved flies at the velocity it was given: gravity and pressure are both in it.
template <class Selection>
struct Predict {
  Selection select;
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
    if constexpr (Selection::everyone) {
      v.y -= gravity * dt;
    } else {
      v.y -= select.falls(i) * gravity * dt;
    }
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

template <class Selection>
void launch(FluidState& state, Selection select) {
  auto& p = state.particles;
  const auto& k = state.parameters;
  for_each("predict", p.size(),
           Predict<Selection>{select, p.position.data(), p.velocity.data(), p.predicted.data(), state.walls,
                              state.refuge, state.guard(), k.gravity, k.dt, k.longest_step, k.wall_gap});
}

void build_neighbours(FluidState& state) {
  auto* dropped = &state.guard()->neighbours_dropped;
  auto& p = state.particles;
  if (state.one_level) {
    state.grid.build(p, NeighbourList::margin);
  } else {
    state.grid.build(p, NeighbourList::margin, state.supports);
  }
  state.lists_by_slot = !state.all_active;
  state.lists_hold = state.all_active;
  if (state.all_active) {
    state.one_level ? state.neighbours.build(p, state.grid, dropped)
                    : state.neighbours.build_mixed(p, state.grid, dropped);
  } else {
    state.activation.list_active(p);
    if (state.one_level) {
      state.neighbours.build(p, state.grid, state.active(), dropped);
    } else if (state.substep + 1 < state.parameters.substeps) {
      state.neighbours.build_mixed(p, state.grid, state.active(), dropped);
    } else {
      // The next frame's levels compare everyone.
      state.neighbours.build_mixed(p, state.grid, EverySlot{state.activation.slots.data()}, dropped);
      state.lists_hold = true;
    }
  }
}

void run(FluidState& state) {
  state.all_active ? launch(state, AllParticles{}) : launch(state, state.active());
}

}  // namespace

Stage predict_stage() {
  return {"predict",
          "Macklin and Mueller 2013, Alg. 1 lines 1-4",
          Phase::Substep,
          columns(Column::Position, Column::Velocity),
          columns(Column::Predicted, Column::Position, Column::Velocity),
          [](const Demand&) -> std::string { return "every method moves its particles"; },
          run};
}

Stage neighbours_stage() {
  return {"neighbours",
          "compact grid and one combined list a substep",
          Phase::Substep,
          columns(Column::Predicted, Column::Position, Column::Velocity, Column::Id, Column::Level),
          columns(Column::Neighbours),
          [](const Demand&) -> std::string { return "the density constraint needs neighbours"; },
          build_neighbours};
}

}  // namespace sim::SIM_BACKEND
