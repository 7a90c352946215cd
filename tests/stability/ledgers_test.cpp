/// The balances of the study's scenes close with splits, merges, resting particles and nozzles.

#include "tests/stability/ledger.hpp"

#include "tests/libsim/fluid_helpers.hpp"

namespace {

using ledger_test::Ledger;
using sim::Backend;
using sim::MethodKind;

struct Case {
  const char* scene;
  MethodKind method;
};

void books_close(Backend backend, const Case& run, std::int64_t n_star, int frames) {
  const std::string name = std::string(run.scene) + " " + sim::method_name(run.method);
  SCOPED_TRACE(name);
  const auto scene = sim::read_scene(std::string("data/scenes/") + run.scene + ".toml");
  sim::SimulationOptions options;
  options.method = run.method;
  options.backend = backend;
  options.n_star = n_star;
  options.wall_impulse = true;
  options.temporal.fixed_tau = -6;
  const bool adaptive = sim::traits_of(run.method).adaptive();
  const auto& size = scene.tank_size_m;
  const double reach = size[0] / 4;
  const sim::Vec3d middle{size[0] / 3, scene.water.front().max_m[1] / 2, size[2] / 2};
  if (adaptive) options.forced_targets = sim::TargetRegion{middle, reach, 0, 3};
  const auto fluid = sim::make_simulation(scene, options);
  Ledger ledger(*fluid, scene, n_star);
  std::int64_t rested = 0;
  for (int frame = 0; frame < frames; ++frame) {
    // A region of fine water moves through the tank.
    if (adaptive)
      fluid->force_targets({{middle[0] * (1 + std::sin(frame * 0.1)), middle[1], middle[2]}, reach, 0, 3});
    fluid->step_frame();
    ledger.frame();
    if (const auto& went_by = fluid->account().temporal) rested += fluid->particle_count() - went_by->active;
  }
  const auto books = ledger.balance();
  const auto report = fluid->report();
  std::printf(
      "%s: %llu splits, %llu merges, %lld rests; open %.1e, unattributed %.1e, with rests %.1e, event %.1e, "
      "energy %.4f\n",
      name.c_str(), static_cast<unsigned long long>(report.levels.splits),
      static_cast<unsigned long long>(report.levels.merges), static_cast<long long>(rested), books.open,
      books.unattributed, books.rests, books.event, books.energy);
  EXPECT_LT(books.open, 1e-9);
  EXPECT_LT(books.forces, 1e-5) << "g dt in single precision";
  EXPECT_LT(books.event, 1e-6);
  if (adaptive) {
    EXPECT_GT(report.levels.splits, 50u);
    EXPECT_GT(report.levels.merges, 200u);
  }
  if (sim::traits_of(run.method).temporal) {
    // Resting (unsolved) particles do not yield when solved ones push them. A part of this momentum comes
    // back in the velocity changes that they take from the velocity grid.
    EXPECT_GT(rested, 50);
    EXPECT_LT(books.rests, 0.1);
  } else {
    EXPECT_LT(books.unattributed, 1e-3);
  }
  // The largest energy over that of the start and of the poured water; the target is 1. With levels 1.03 to
  // 1.06 were measured, because merged particles overlap and are pushed apart, and coarse water stands
  // higher. (A filter of velocity changes after splits and merges that was as strong on moving water as on
  // resting water gave 1.04, but with it dams lost energy.) With one level 1.0020 was measured: settled water
  // starts still, and a jet makes it jitter, which adds energy. (Settled water that jittered too gave
  // 1.0000.)
  EXPECT_LT(books.energy, adaptive ? 1.08 : 1.003);
}

void books_of(Backend backend, const char* scene, std::int64_t n_star) {
  for (const auto method : {MethodKind::HiRes, MethodKind::Ours, MethodKind::OursTsp})
    books_close(backend, {scene, method}, n_star, 45);
}
TEST(Ledgers, SingleDamsBooksClose) { books_of(Backend::Cpu, "single_dam", 128); }
TEST(Ledgers, JetImpactsBooksClose) { books_of(Backend::Cpu, "jet_impact", 128); }
TEST(Ledgers, FaucetsBooksClose) { books_of(Backend::Cpu, "faucet", 128); }
TEST(LedgersGpu, SingleDamsBooksClose) { books_of(Backend::Cuda, "single_dam", 2048); }
TEST(LedgersGpu, JetImpactsBooksClose) { books_of(Backend::Cuda, "jet_impact", 2048); }
TEST(LedgersGpu, FaucetsBooksClose) { books_of(Backend::Cuda, "faucet", 2048); }

}  // namespace
