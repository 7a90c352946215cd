/// Loops over neighbours shared by two effects of one scene: if both are listed, one loop computes the sums
/// of both.

#include "libsim/solver/effects/loops/conduction.hpp"
#include "libsim/solver/effects/loops/curl.hpp"
#include "libsim/solver/effects/loops/surface_normals.hpp"

namespace sim::SIM_BACKEND {

namespace {

using NormalAndHeatView = ColumnView<columns(Column::Position, Column::Neighbours),
                                     columns(Column::Normal, Column::Temperature, Column::TemperatureNext)>;

void find_normals_and_conduct(FluidState& state, NormalAndHeatView p) {
  with_surface_normals(state, p, [&](auto normals) {
    run_pair_loop("normals and heat", state, p, normals, conduction_of(state, p));
  });
  p.swap<Column::Temperature, Column::TemperatureNext>();
}

using CurlAndHeatView = ColumnView<columns(Column::Position, Column::Velocity, Column::Neighbours),
                                   columns(Column::Normal, Column::Temperature, Column::TemperatureNext)>;

void find_curl_and_conduct(FluidState& state, CurlAndHeatView p) {
  run_pair_loop("vorticity and heat", state, p, curl_of(state, p), conduction_of(state, p));
  p.swap<Column::Temperature, Column::TemperatureNext>();
}

}  // namespace

std::vector<SharedLoop> shared_loops() {
  return {{SharedTerm::SurfaceNormals, SharedTerm::Conduction,
           stage_of<find_normals_and_conduct>({.name = "normals and heat", .phase = Phase::SubstepEnd})},
          {SharedTerm::Curl, SharedTerm::Conduction,
           stage_of<find_curl_and_conduct>({.name = "vorticity and heat", .phase = Phase::SubstepEnd})}};
}

}  // namespace sim::SIM_BACKEND
