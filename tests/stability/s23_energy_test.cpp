/// S23: water that nothing drives gains no energy.

#include "tests/stability/stability_helpers.hpp"

namespace {

using namespace stability_test;

/// Potential and kinetic, over m_*, m2/s2.
double energy(const std::vector<ParticleState>& state) {
  double sum = 0;
  for (const auto& p : state) {
    const double v = std::hypot(static_cast<double>(p.vx_m_s), static_cast<double>(p.vy_m_s),
                                static_cast<double>(p.vz_m_s));
    sum += (1 << p.level) * (0.5 * v * v + gravity * static_cast<double>(p.y_m));
  }
  return sum;
}

void dam_gains_none(Backend backend, std::int64_t n_star, sim::MethodKind method) {
  sim::SimulationOptions options;
  options.n_star = n_star;
  options.method = method;
  options.backend = backend;
  const auto fluid = sim::make_simulation(sim::read_scene("data/scenes/peers_dam.toml"), options);
  // The first two frames lift the lattice to its rest density, by half a per cent at 512 particles.
  for (int frame = 0; frame < 2; ++frame) fluid->step_frame();
  const double start = energy(fluid->read_state());
  double most = 0, last = 0;
  for (int frame = 0; frame < 120; ++frame) {
    fluid->step_frame();
    last = energy(fluid->read_state()) / start;
    most = std::max(most, last);
  }
  std::printf("S23, %s: energy at most %.4f of the third frame's, %.4f at last\n",
              sim::method_name(method).c_str(), most, last);
  EXPECT_LE(most, 1.01);
  EXPECT_LT(last, 0.95) << "the dam must have broken";
}

TEST(S23Energy, ADamGainsNone) {
  for (const auto method : {sim::MethodKind::LoRes, sim::MethodKind::HiRes, sim::MethodKind::FovFluid,
                            sim::MethodKind::Ours, sim::MethodKind::OursTsp}) {
    dam_gains_none(Backend::Cpu, 512, method);
  }
}
TEST(S23EnergyGpu, ADamGainsNone) { dam_gains_none(Backend::Cuda, 32 * 1024, sim::MethodKind::HiRes); }

}  // namespace
