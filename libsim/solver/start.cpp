#include "libsim/solver/fluid_simulation.hpp"

namespace sim::SIM_BACKEND {

namespace {

constexpr double enough = 0.01;  ///< mean compression of a start's mass

/// Weighted by mass: a mean over particles would let many fine ones outvote coarse water that is still
/// compressed.
struct Excess {
  const float* density;
  const std::uint8_t* level;
  float* excess;
  float* mass;
  SIM_FN void operator()(int i) const {
    mass[i] = static_cast<float>(1 << level[i]);
    excess[i] = mass[i] * fmaxf(density[i] - 1, 0.0f);
  }
};

double mean_compression(FluidState& state, Array<float>& excess, Array<float>& mass) {
  auto& p = state.particles;
  copy_within(p.predicted.data(), p.position.data(), p.position.size() * sizeof(Vec4));
  neighbours_stage().run(state);
  if (state.neighbours.grow()) neighbours_stage().run(state);
  density_stage().run(state);
  for_each("start compression", p.size(),
           Excess{p.density.data(), p.level.data(), excess.data(), mass.data()});
  return fixed_order_sum(excess, p.size()) / fixed_order_sum(mass, p.size());
}

}  // namespace

RelaxedStart relax_start(FluidState& state, int most) {
  auto& p = state.particles;
  RelaxedStart out;
  if (p.size() == 0) return out;
  Array<float> excess(static_cast<std::size_t>(p.size()));
  Array<float> mass(static_cast<std::size_t>(p.size()));
  state.iteration = 0;  // no momentum
  for (;; ++out.projections) {
    out.compression = mean_compression(state, excess, mass);
    if (out.compression < enough || out.projections == most) return out;
    displacement_stage().run(state);
    copy_within(p.position.data(), p.predicted.data(), p.position.size() * sizeof(Vec4));
  }
}

void start_velocity_grid(FluidState& state) {
  state.activation.beta = 1;
  activation_stage().run(state);
  velocity_grid_stage().run(state);
}

}  // namespace sim::SIM_BACKEND
