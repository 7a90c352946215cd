#include "libsim/solver/settled_state.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <variant>

#include "libsim/solver/state_file.hpp"
#include "stats/base/file.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

namespace fs = std::filesystem;

class SettledState : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("settled_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    scene_ = fluid_test::tank({2, 2, 2}, {1, 1, 1}, 10);
    scene_.sha256 = "of a test";
    options_.n_star = 64;
    options_.cache = folder_;
    options_.settling = [this](int, int) { ++settled_frames_; };
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::vector<fluid_test::ParticleState> after_five_frames() {
    const auto fluid = sim::make_simulation(scene_, options_);
    for (int frame = 0; frame < 5; ++frame) fluid->step_frame();
    return fluid->read_state();
  }
  fs::path only_file() const { return fs::directory_iterator(folder_)->path(); }

  static bool same(const std::vector<fluid_test::ParticleState>& a,
                   const std::vector<fluid_test::ParticleState>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
  }

  fs::path folder_;
  sim::Scene scene_;
  sim::SimulationOptions options_;
  int settled_frames_ = 0;
};

TEST_F(SettledState, SecondRunStartsFromTheKeptStateBitForBit) {
  const auto first = after_five_frames();
  EXPECT_EQ(settled_frames_, 10);
  EXPECT_TRUE(same(first, after_five_frames()));
  EXPECT_EQ(settled_frames_, 10) << "the second run must not settle";
  options_.cache.clear();
  EXPECT_TRUE(same(first, after_five_frames()));
  EXPECT_EQ(settled_frames_, 20) << "without a folder every run settles";
}

TEST_F(SettledState, ParticlesBeginInOneOrderWhetherKeptOrJustSettled) {
  const auto at_frame_0 = [&] {
    std::vector<sim::RenderParticle> out;
    sim::make_simulation(scene_, options_)->read_particles(out);
    return out;
  };
  const auto just_settled = at_frame_0();
  const auto kept = at_frame_0();
  options_.cache.clear();
  const auto never_kept = at_frame_0();
  ASSERT_EQ(just_settled.size(), 512u);
  for (const auto* other : {&kept, &never_kept}) {
    ASSERT_EQ(other->size(), just_settled.size());
    EXPECT_EQ(std::memcmp(other->data(), just_settled.data(), 512 * sizeof kept[0]), 0);
  }
}

TEST_F(SettledState, EveryChoiceHasItsOwnState) {
  std::vector<std::string> keys{sim::settled_key(scene_, options_)};
  const auto add = [&] { keys.push_back(sim::settled_key(scene_, options_)); };
  options_.n_star = 128;
  add();
  options_.method = sim::MethodKind::LoRes;
  add();
  scene_.sha256 = "of another";
  add();
  scene_.effects = {{sim::EffectKind::AirDrag, 1}};
  add();
  scene_.effects[0].coefficient = 1.0000001;
  add();
  std::sort(keys.begin(), keys.end());
  EXPECT_EQ(std::adjacent_find(keys.begin(), keys.end()), keys.end());
}

TEST_F(SettledState, EveryNumberOfTheSolverHasItsOwnStateAndItsOwnRun) {
  for (const sim::SolverNumber& number : sim::solver_numbers()) {
    auto other = options_;
    std::visit([&](auto member) { other.*member += 1; }, number.value);
    EXPECT_NE(sim::settled_key(scene_, other), sim::settled_key(scene_, options_)) << number.name;
    EXPECT_NE(sim::run_key(scene_, other), sim::run_key(scene_, options_)) << number.name;
  }
}

TEST_F(SettledState, DamagedFileIsSettledAgain) {
  const auto first = after_five_frames();
  for (const bool shorten : {true, false}) {
    const auto path = only_file();
    if (shorten) {
      fs::resize_file(path, fs::file_size(path) - 32);
    } else {
      std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
      file.seekp(100);
      file.put('x');
    }
    const int before = settled_frames_;
    EXPECT_TRUE(same(first, after_five_frames()));
    EXPECT_EQ(settled_frames_, before + 10);
  }
}

/// The file's hash matches, but its content is not a valid state of water.
TEST_F(SettledState, StateThatIsNotFiniteOrOfOtherParticlesIsSettledAgain) {
  const auto first = after_five_frames();
  const auto sound = *sim::read_settled(folder_, sim::settled_key(scene_, options_));
  const auto nan = std::numeric_limits<float>::quiet_NaN();
  const auto infinite = std::numeric_limits<float>::infinity();
  for (const auto& spoil : std::vector<std::function<void(fluid_test::ParticleState&)>>{
           [&](auto& p) { p.x_m = nan; }, [&](auto& p) { p.vz_m_s = infinite; }, [](auto& p) { p.level = 9; },
           [](auto& p) { p.id = 0; }}) {
    auto state = sound;
    spoil(state[7]);
    const std::string body(reinterpret_cast<const char*>(state.data()), state.size() * sizeof state[0]);
    base::write_file_atomically(only_file(), base::sha256_hex(body) + body);
    const int before = settled_frames_;
    EXPECT_TRUE(same(first, after_five_frames()));
    EXPECT_EQ(settled_frames_, before + 10);
  }
}

TEST_F(SettledState, StateOfNoParticlesIsNone) {
  fs::create_directories(folder_);
  base::write_file_atomically(folder_ / "empty.settled", base::sha256_hex(""));
  EXPECT_FALSE(sim::read_settled(folder_, "empty"));
}

TEST_F(SettledState, FolderThatCannotBeWrittenIsNoError) {
  options_.cache = "/proc/no/such/folder";
  EXPECT_EQ(after_five_frames().size(), 512u);
}

}  // namespace
