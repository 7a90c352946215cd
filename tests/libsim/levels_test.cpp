/// Splitting and merging (paper 3.3): bad input, and the memory of methods with one level. tests/stability
/// has the hard cases.

#include "stats/base/error.hpp"
#include "tests/libsim/levels_helpers.hpp"

namespace {

using namespace levels_test;

TEST(Levels, BadInputIsNamed) {
  const auto scene = fluid_test::tank({2, 2, 2}, {8 * d, 8 * d, 8 * d});
  for (const int n : {-1, 0, 5}) {
    auto options = options_for(Backend::Cpu, 64, everywhere(0));
    options.levels = n;
    EXPECT_THROW(sim::make_simulation(scene, options), base::Error) << n;
  }
  for (const auto& bad : std::vector<ParticleState>{{0, 4, 1, 1, 1, 0, 0, 0},
                                                    {0, -1, 1, 1, 1, 0, 0, 0},
                                                    {512, 0, 1, 1, 1, 0, 0, 0},
                                                    {-1, 0, 1, 1, 1, 0, 0, 0}}) {
    auto options = options_for(Backend::Cpu, 64, everywhere(0));
    options.start = std::vector<ParticleState>{bad};
    EXPECT_THROW(sim::make_simulation(scene, options), base::Error) << bad.id;
  }
  auto options = options_for(Backend::Cpu, 64, everywhere(4));
  EXPECT_THROW(sim::make_simulation(scene, options), base::Error);
  options = options_for(Backend::Cpu, 64, everywhere(0));
  options.start = std::vector<ParticleState>{{1, 0, 1, 1, 1, 0, 0, 0}, {1, 0, 1, 1, 1, 0, 0, 0}};
  EXPECT_THROW(sim::make_simulation(scene, options), base::Error);
  options.start = std::vector<ParticleState>{};
  const auto fluid = sim::make_simulation(scene, options);
  fluid->step_frame();
  EXPECT_EQ(fluid->report().particles, 0);
}

TEST(Levels, OneLevelMethodsRunAndHoldNothingOfThem) {
  const auto scene = fluid_test::tank({2, 2, 2}, {8 * d, 8 * d, 8 * d});
  std::size_t bytes[3] = {};
  int at = 0;
  for (const auto kind : {sim::MethodKind::LoRes, sim::MethodKind::HiRes, sim::MethodKind::Ours}) {
    auto options = options_for(Backend::Cpu, 64, everywhere(0));
    options.method = kind;
    if (kind != sim::MethodKind::Ours) options.forced_targets.reset();
    const auto fluid = sim::make_simulation(scene, options);
    fluid->step_frame();
    const std::string said = fluid->explain();
    for (const char* pass : {"split and merge", "graded targets", "frame neighbours"}) {
      const bool runs = said.find(std::string("frame start  ") + pass) != std::string::npos;
      EXPECT_EQ(runs, kind == sim::MethodKind::Ours) << pass;
    }
    for (const char* column : {" target", " history", " waiting", " age"}) {
      const bool held = said.substr(said.find("columns:")).find(column) != std::string::npos;
      EXPECT_EQ(held, kind == sim::MethodKind::Ours) << column;
    }
    bytes[at++] = fluid->particle_bytes();
  }
  EXPECT_EQ(bytes[1], 8 * bytes[0]);
  EXPECT_GT(bytes[2], bytes[1]);
}

}  // namespace
