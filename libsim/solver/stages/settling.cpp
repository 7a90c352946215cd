#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct Damp {
  Vec4* velocity;
  SIM_FN void operator()(int i) const { velocity[i] = with_w(0.9f * xyz(velocity[i]), 0); }
};

using SettlingColumns = ColumnView<columns(Column::Velocity), columns(Column::Velocity)>;

void run_settling(FluidState&, SettlingColumns p) { for_each("settling", p.size(), Damp{p.velocity()}); }

}  // namespace

Stage settling_stage() {
  return stage_of<run_settling>({.name = "settling",
                                 .source = "fill rule of the scenes: velocity x 0.9 each frame",
                                 .phase = Phase::FrameEnd,
                                 .called_for = [](const Demand& demand) -> std::string {
                                   return demand.settling ? "the gate is closed" : "";
                                 }});
}

}  // namespace sim::SIM_BACKEND
