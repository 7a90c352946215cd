/// S18: a run that is saved and resumed continues bit for bit.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <omp.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <functional>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/stability/stability_helpers.hpp"

namespace {

using namespace stability_test;
using sim::MethodKind;
namespace fs = std::filesystem;

class S18Restart : public testing::Test {
 protected:
  void TearDown() override { fs::remove(path_); }
  const fs::path path_ = fs::path(testing::TempDir()) / ("state_" + std::to_string(::getpid()));
};
class S18RestartGpu : public S18Restart {};

/// A jet, a hole and a dam: splits, merges, rests, exchanges of levels and an outflow.
sim::Scene busy() {
  auto scene = fluid_test::tank({3, 3, 1.8}, {1.8, 1.5, 1.8}, 5);
  scene.nozzles.push_back(
      {.diameter_m = 0.5, .position_m = {2.2, 2, 0.9}, .speed_m_s = 5, .on_frames = 9, .off_frames = 4});
  scene.recirculation_corner_m = 0.6;
  scene.outlets.push_back({sim::Wall::HighX, {0, 0}, {0.4, 1.8}});
  scene.view = {.eye_m = {1.2, 2, 5}, .target_m = {1.2, 0.5, 1.2}};
  return scene;
}

sim::SimulationOptions options_for(Backend backend, MethodKind method) {
  sim::SimulationOptions out;
  out.backend = backend;
  out.method = method;
  out.n_star = 180;
  return out;
}

/// A wavy, moving surface in front of everything.
sim::GBuffer picture_of(const sim::Scene& scene, int frame) {
  constexpr int width = 64, height = 36;
  sim::GBuffer out;
  out.width = width;
  out.height = height;
  out.view = sim::make_view(scene.view, width, height);
  for (int k = 0; k < width * height; ++k) {
    const auto slope = static_cast<float>(0.6 * std::sin(0.3 * (k % width) + 0.2 * frame));
    const float length = std::sqrt(1 + slope * slope);
    out.depth.push_back(3 + slope);
    for (const float n : {slope / length, 0.0f, 1 / length}) out.normal.push_back(n);
  }
  out.radius_scale = 1;
  return out;
}

/// Frames at changing frame rates, with a gaze that is lost at times; every third frame has no new look.
void run(sim::Simulation& fluid, const sim::Scene& scene, int frames) {
  for (int k = 0; k < frames; ++k) {
    const int frame = fluid.frame();
    const sim::GBuffer seen = picture_of(scene, frame);
    if (frame % 3 > 0) {
      const sim::Gaze gaze{scene.view.eye_m, {-0.3 + 0.05 * (frame % 11), -0.2, -1}, frame % 5 > 0};
      fluid.look({{{gaze, seen.view, &seen}}});
    }
    fluid.step_frame();
    fluid.frame_time(70 + 25 * (frame % 2));
  }
}

std::string read_all(sim::Simulation& fluid) {
  std::string out;
  const auto add = [&](const auto& values) {
    out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof values[0]);
  };
  add(fluid.read_state());
  add(fluid.read_ids());
  std::vector<sim::ParticleSaliency> saliency;
  fluid.read_saliency(saliency);
  add(saliency);
  std::vector<float> field;
  for (const auto kind : {sim::ParticleField::DensityError, sim::ParticleField::Active}) {
    fluid.read_field(kind, field);
    add(field);
  }
  const auto r = fluid.report();
  const auto account = fluid.account();
  add(account.particles_by_level);
  for (const double value :
       {static_cast<double>(r.frame), static_cast<double>(r.substeps.taken), r.time_s, r.density_max,
        r.jump_share, r.temporal.beta, r.temporal.tau.value_or(-1e9), r.levels.energy_lost_j})
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
  for (const std::int64_t count :
       {r.particles, r.mass_units, r.poured, r.particles_in, r.particles_out, r.drained, r.reservoir,
        static_cast<std::int64_t>(r.levels.born), static_cast<std::int64_t>(r.levels.merges),
        static_cast<std::int64_t>(r.levels.split_deferred),
        static_cast<std::int64_t>(r.guards.wall_projected), static_cast<std::int64_t>(r.guards.gaze_lost),
        static_cast<std::int64_t>(account.guards->wall_projected), r.temporal.active})
    out.append(reinterpret_cast<const char*>(&count), sizeof count);
  return out;
}

void goes_on_bit_for_bit(Backend backend, const sim::Scene& scene, const fs::path& path) {
  // More than the 30 frames whose durations tau (which decides how many particles may rest) is computed from.
  // Odd, so that saliency's flow, which is computed every second frame, is not due.
  constexpr int half = 37;
  for (const auto& traits : sim::all_methods()) {
    SCOPED_TRACE(sim::method_name(traits.kind));
    auto options = options_for(backend, traits.kind);
    const auto through = sim::make_simulation(scene, options);
    run(*through, scene, half);
    // Saving must not change a run: `through` is never saved.
    const auto saved = sim::make_simulation(scene, options);
    run(*saved, scene, half);
    saved->save_state(path);
    options.resume_from = path;
    const int threads = omp_get_max_threads();
    if (backend == Backend::Cpu) omp_set_num_threads(threads > 1 ? 1 : 3);
    const auto resumed = sim::make_simulation(scene, options);
    EXPECT_EQ(read_all(*resumed), read_all(*through));
    run(*resumed, scene, half);
    omp_set_num_threads(threads);
    run(*through, scene, half);
    run(*saved, scene, half);
    const std::string end = read_all(*through);
    EXPECT_EQ(read_all(*saved), end);
    EXPECT_EQ(read_all(*resumed), end);
    const auto report = through->report();
    EXPECT_EQ(report.drained > 0, !scene.outlets.empty());
    EXPECT_EQ(report.poured > 0, !scene.nozzles.empty());
    if (traits.adaptive()) {
      EXPECT_GT(report.levels.born, 0u);
      EXPECT_GT(report.levels.merges, 0u);
    }
    if (traits.temporal) {
      EXPECT_LT(report.temporal.active, report.particles) << "somebody must rest";
    }
  }
}
TEST_F(S18Restart, FiveMethodsGoOnBitForBit) { goes_on_bit_for_bit(Backend::Cpu, busy(), path_); }
TEST_F(S18RestartGpu, FiveMethodsGoOnBitForBit) { goes_on_bit_for_bit(Backend::Cuda, busy(), path_); }

/// Without inflow and outflow, the lists of a frame's last substep are reused for the next frame's levels.
sim::Scene dam() {
  auto scene = busy();
  scene.nozzles.clear();
  scene.outlets.clear();
  return scene;
}
TEST_F(S18Restart, ListsThatHoldGoOnToo) { goes_on_bit_for_bit(Backend::Cpu, dam(), path_); }
TEST_F(S18RestartGpu, ListsThatHoldGoOnToo) { goes_on_bit_for_bit(Backend::Cuda, dam(), path_); }

std::string error_of(const sim::Scene& scene, sim::SimulationOptions options, const fs::path& path) {
  options.resume_from = path;
  try {
    sim::make_simulation(scene, options);
  } catch (const base::Error& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(S18Restart, AFileThatDoesNotFitIsOneClearError) {
  using testing::AllOf;
  using testing::HasSubstr;
  const auto scene = busy();
  const auto options = options_for(Backend::Cpu, MethodKind::HiRes);
  EXPECT_THAT(error_of(scene, options, path_), HasSubstr(path_.string()));
  const auto fluid = sim::make_simulation(scene, options);
  fluid->step_frame();
  fluid->save_state(path_);
  EXPECT_EQ(error_of(scene, options, path_), "no error");
  auto other = options;
  other.n_star = 192;
  EXPECT_THAT(error_of(scene, other, path_),
              AllOf(HasSubstr("another scene"), HasSubstr("mend: resume with")));
  other = options;
  other.readings.alpha = 0.5;
  EXPECT_THAT(error_of(scene, other, path_), HasSubstr("another scene"));
  auto deeper = scene;
  deeper.outlets[0].max_m[0] += 0.1;
  EXPECT_THAT(error_of(deeper, options, path_), HasSubstr("another scene"));
  other = options;
  other.start = fluid->read_state();
  EXPECT_THAT(error_of(scene, other, path_), HasSubstr("only the saved state"));

  const std::string good = base::read_file(path_, 1 << 28);
  const auto with = [&](const std::string& bytes) {
    base::write_file_atomically(path_, bytes);
    return error_of(scene, options, path_);
  };
  for (const std::size_t cut : {std::size_t{20}, std::size_t{140}, good.size() / 2, good.size() - 1})
    EXPECT_THAT(with(good.substr(0, cut)), AllOf(HasSubstr("cut short"), HasSubstr(path_.string()))) << cut;
  EXPECT_THAT(with(""), HasSubstr("is not a state"));
  EXPECT_THAT(with(std::string(1000, 'x')), HasSubstr("is not a state"));
  EXPECT_THAT(with(good + "x"), HasSubstr("damaged"));
  for (const std::size_t at : {good.size() / 3, good.size() - 5}) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 1);
    EXPECT_THAT(with(bad), HasSubstr("damaged")) << at;
  }
  std::string newer = good;
  newer[std::strlen("ViP-Lab state\n")] = 9;
  EXPECT_THAT(with(newer), HasSubstr("has format 9"));
  EXPECT_EQ(with(good), "no error");
}

TEST_F(S18Restart, APlaceThatCannotBeWrittenIsAnError) {
  base::write_file_atomically(path_, "a file, no folder");
  const auto fluid = sim::make_simulation(busy(), options_for(Backend::Cpu, MethodKind::LoRes));
  EXPECT_THROW(fluid->save_state(path_ / "state"), base::Error);
}

}  // namespace
