#include "libsim/solver/fluid_simulation.hpp"

namespace sim::SIM_BACKEND {

namespace {

constexpr double enough = 0.01;  ///< mean compression of a start

struct Excess {
  const float* density;
  float* excess;
  SIM_FN void operator()(int i) const { excess[i] = fmaxf(density[i] - 1, 0.0f); }
};

double mean_compression(FluidState& state, Array<float>& excess) {
  auto& p = state.particles;
  copy_within(p.predicted.data(), p.position.data(), p.position.size() * sizeof(Vec4));
  neighbours_stage().run(state);
  state.neighbours.grow();
  density_stage().run(state);
  for_each("start compression", p.size(), Excess{p.density.data(), excess.data()});
  return fixed_order_sum(excess, p.size()) / p.size();
}

}  // namespace

int relax_start(FluidState& state, int most) {
  auto& p = state.particles;
  if (p.size() == 0) return 0;
  Array<float> excess(static_cast<std::size_t>(p.size()));
  state.iteration = 0;  // no momentum
  int done = 0;
  while (!(mean_compression(state, excess) < enough) && done < most) {
    displacement_stage().run(state);
    copy_within(p.position.data(), p.predicted.data(), p.position.size() * sizeof(Vec4));
    ++done;
  }
  return done;
}

void start_velocity_grid(FluidState& state) {
  state.activation.beta = 1;
  activation_stage().run(state);
  velocity_grid_stage().run(state);
}

}  // namespace sim::SIM_BACKEND
