/// Loops over neighbours that two effects of one scene share: where both are listed, one walk finds the sums
/// of both.

#include "libsim/solver/effects/loops/conduction.hpp"
#include "libsim/solver/effects/loops/surface_normals.hpp"

namespace sim::SIM_BACKEND {

namespace {

using View = ColumnView<columns(Column::Position, Column::Neighbours),
                        columns(Column::Normal, Column::Temperature, Column::TemperatureNext)>;

void find_normals_and_conduct(FluidState& state, View p) {
  with_surface_normals(state, p, [&](auto normals) {
    run_pair_loop("normals and heat", state, p, normals, conduction_of(state, p));
  });
  p.swap<Column::Temperature, Column::TemperatureNext>();
}

}  // namespace

std::vector<SharedLoop> shared_loops() {
  return {{SharedTerm::SurfaceNormals, SharedTerm::Conduction,
           stage_of<find_normals_and_conduct>({.name = "normals and heat", .phase = Phase::SubstepEnd})}};
}

}  // namespace sim::SIM_BACKEND
