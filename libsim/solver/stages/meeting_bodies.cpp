/// Free obstacles that meet others.

#include "libsim/particles/meeting.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

void meet(FluidState& state, ColumnView<ColumnSet{}, ColumnSet{}>) {
  auto& o = state.obstacles;
  const Meeting meeting{.bodies = o.bodies.data(),
                        .free = o.free.data(),
                        .meshes = o.meshes.data(),
                        .friction = o.friction.data(),
                        .by_others = o.by_others.data(),
                        .walls = state.walls,
                        .drive = body_drive(state),
                        .spacing = state.finest_support / 2,
                        .count = o.count(),
                        .feelers = o.feelers,
                        .rough = o.rough};
  constexpr int threads = 256;
  in_one_block("meet bodies", threads, meeting.bytes(), o.meeting_room, meeting);
}

}  // namespace

Stage bodies_meet_stage() {
  return stage_of<meet>({.name = "bodies meet",
                         .source = "Newton's and Euler's laws, inelastic contact, Coulomb's friction",
                         .phase = Phase::Substep,
                         .called_for = [](const Demand& demand) -> std::string {
                           return demand.obstacles_meet ? "a free obstacle may meet another, or has friction"
                                                        : "";
                         }});
}

}  // namespace sim::SIM_BACKEND
