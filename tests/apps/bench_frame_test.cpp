#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "libsim/measure/timed_run.hpp"
#include "libsim/scene/effects.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/process.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/common/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;

/// Runs vip-bench frame on 1,024 particles.
class BenchFrameE2e : public ::testing::Test {
 protected:
  int bench(const std::string& more, const std::string& environment = "") {
    const auto ended = apps::test::run_shell("env -u DISPLAY -u WAYLAND_DISPLAY " + environment +
                                             " " VIP_BIN_DIR
                                             "/vip-bench frame data/scenes/peers_dam.toml --n-star 128 "
                                             "--backend cpu --frames 2 --warm-up 0 --json " +
                                             json().string() + " " + more);
    text = ended.out;
    return ended.exit_code;
  }

  fs::path json() const { return folder / "frame.json"; }
  base::Json figures() const { return base::Json::parse(base::read_file(json(), 1 << 20)); }

  test::TemporaryFolder folder;
  std::string text;  ///< stdout and stderr
};

TEST_F(BenchFrameE2e, TimesSolverAndPicturesApart) {
  ASSERT_EQ(bench("--size 64x48 --views 2"), 0) << text;
  const auto result = figures();
  for (const char* key : {"solve_ms_median", "transfer_ms_median", "render_ms_median", "render_ms_p95"})
    EXPECT_GT(result[key].get<double>(), 0) << key;
  for (const std::string part : {"solve", "transfer", "render", "frame"}) {
    const auto at = [&](const char* rank) { return result[part + "_ms_" + rank].get<double>(); };
    EXPECT_GE(at("p99"), at("p95")) << part;
    EXPECT_GE(at("p95"), at("median")) << part;
  }
  EXPECT_NE(text.find(" p99"), std::string::npos) << text;
  // A frame is solved, transferred and drawn, so its time is longer than that of its drawing.
  EXPECT_GT(result["frame_ms_median"].get<double>(), result["render_ms_median"].get<double>());
  EXPECT_EQ(result["transfer"], "uploaded");
  EXPECT_EQ(result["render_views"], 2);
  EXPECT_EQ(result["render_width_px"], 64);
  for (const char* pass : {"splat small", "front", "filter", "shade"})
    EXPECT_TRUE(result["passes"].contains(pass)) << pass;
  EXPECT_NE(text.find("uploaded"), std::string::npos);
}

TEST_F(BenchFrameE2e, TimesTheSolverWithoutPictures) {
  ASSERT_EQ(bench("", "__EGL_VENDOR_LIBRARY_FILENAMES=/nowhere.json"), 0) << text;
  EXPECT_GT(figures()["solve_ms_median"].get<double>(), 0);
  EXPECT_FALSE(figures().contains("render_ms_median"));
  EXPECT_NE(figures()["render_left_out"].get<std::string>().find("OpenGL"), std::string::npos);
  EXPECT_NE(text.find("left out"), std::string::npos);
  ASSERT_EQ(bench("--no-render"), 0) << text;
  EXPECT_EQ(figures()["render_left_out"], "--no-render");
}

TEST_F(BenchFrameE2e, TimesEveryLaunch) {
  ASSERT_EQ(bench("--no-render --passes"), 0) << text;
  const auto launches = figures()["launches"];
  const auto density = std::find_if(launches.begin(), launches.end(),
                                    [](const auto& pass) { return pass["pass"] == "density"; });
  ASSERT_NE(density, launches.end());
  EXPECT_GT((*density)["ms_a_frame"].get<double>(), 0);
  EXPECT_GE((*density)["launches_a_frame"].get<double>(), 4);
  EXPECT_NE(text.find("times floor"), std::string::npos) << text;
  const double gb_s = figures()["bandwidth_gb_s"].get<double>();
  EXPECT_GT(gb_s, 0);
  const double floor = (*density)["floor_ms_a_frame"].get<double>();
  EXPECT_NEAR(floor, (*density)["bytes_a_frame"].get<double>() / gb_s / 1e6, 1e-9 * floor);
  EXPECT_NEAR((*density)["times_floor"].get<double>(), (*density)["ms_a_frame"].get<double>() / floor, 1e-6);
  ASSERT_EQ(bench("--no-render"), 0) << text;
  EXPECT_TRUE(figures()["launches"].empty());
  EXPECT_TRUE(figures()["bandwidth_gb_s"].is_null());
}

TEST_F(BenchFrameE2e, StatesThatAreMeasuredAreNoLaunches) {
  const auto launches = [&](const std::string& every) {
    EXPECT_EQ(bench("--no-render --passes --substeps 1 --measure-every " + every), 0) << text;
    double sum = 0;
    const auto result = figures();
    for (const auto& pass : result["launches"]) {
      EXPECT_NE(pass["pass"], "measure");
      sum += pass["launches_a_frame"].get<double>();
    }
    return sum;
  };
  const double every = launches("1");
  EXPECT_GT(every, 0);
  EXPECT_EQ(every, launches("2"));
}

// Levels change every `turn` frames. Measured frames must fall equally often on each frame between two
// changes: with turn = 4, measuring every tenth frame would reach only two of the four.
TEST(TimedRun, MeasuredStatesMeetEachFrameBetweenTurnsAsOften) {
  sim::Readings readings = sim::readings_of(sim::Preset::Tuned);
  for (const int turn : {1, 2, 4, 6}) {
    readings.levels_period_frames = turn;
    for (const int frames : {1, 40, 60, 100, 120, 500}) {
      const int every = measure::tenth_of(frames, sim::MethodKind::Ours, readings);
      std::vector<int> met(static_cast<std::size_t>(turn));
      for (int k = 1; k <= 12; ++k) ++met[static_cast<std::size_t>(k * every % turn)];
      for (const int times : met) EXPECT_EQ(times, 12 / turn) << frames << " frames, turns of " << turn;
      EXPECT_EQ(measure::tenth_of(frames, sim::MethodKind::HiRes, readings), std::max(1, frames / 10));
    }
  }
}

TEST_F(BenchFrameE2e, NamesTheFirstTrouble) {
  ASSERT_EQ(bench("--no-render"), 0) << text;
  EXPECT_TRUE(figures()["divergence"].is_null());
  EXPECT_EQ(text.find("divergence"), std::string::npos) << text;
  // One projection in a frame of a fifth of a second leaves water denser than 1.5 times the rest density,
  // which counts as a divergence.
  ASSERT_EQ(bench("--no-render --substeps 1 --iterations 1 --coarse-cycles 0 --dt 0.2"), 0) << text;
  const auto found = figures()["divergence"];
  EXPECT_GE(found["frame"].get<int>(), 1);
  EXPECT_GT(found["count"].get<int>(), 0);
  EXPECT_EQ(found["where_m"].size(), 3u);
  EXPECT_NE(found["cause"].get<std::string>().find("denser"), std::string::npos) << found;
  EXPECT_NE(text.find("divergence   frame "), std::string::npos) << text;
}

TEST_F(BenchFrameE2e, RefusesBadPictures) {
  EXPECT_EQ(bench("--size 3x3"), 1);
  EXPECT_NE(text.find("--size 3x3"), std::string::npos) << text;
  EXPECT_NE(bench("--views 3"), 0);
  EXPECT_NE(bench("--momentum nan"), 0);
  EXPECT_NE(text.find("nan"), std::string::npos) << text;
  EXPECT_FALSE(fs::exists(json()));
}

TEST_F(BenchFrameE2e, RefusesStepsAndNumbersThatBreakTheWater) {
  for (const char* step : {"1e-300", "0", "-1", "nan", "1e300", "2"}) {
    EXPECT_EQ(bench("--no-render --dt " + std::string(step)), 2) << text;
    EXPECT_NE(text.find("--dt"), std::string::npos) << text;
  }
  EXPECT_EQ(bench("--no-render --dt 1e-5"), 0) << text;
}

TEST_F(BenchFrameE2e, TellsTheBooksOfTheEffectsThatASceneLists) {
  ASSERT_EQ(bench("--no-render"), 0) << text;
  EXPECT_EQ(figures()["effects"], base::Json::object());
  NEEDS_EFFECTS;
  const auto of = [&](const std::string& scene) {
    const auto ended = apps::test::run_shell(VIP_BIN_DIR "/vip-bench frame data/scenes/" + scene +
                                             " --n-star 64 --backend cpu --frames 40 --warm-up 0 --no-render"
                                             " --json " +
                                             json().string());
    text = ended.out;
    return ended.exit_code;
  };
  ASSERT_EQ(of("sea_spray.toml"), 0) << text;
  const auto foam = figures()["effects"]["foam"];
  const auto count = [&](const char* key) { return foam[key].get<std::int64_t>(); };
  EXPECT_GT(count("emitted"), 100);
  EXPECT_GT(count("spray") + count("foam") + count("bubbles"), 0);
  EXPECT_EQ(count("emitted"), count("spray") + count("foam") + count("bubbles") + count("dissolved") +
                                  count("dropped") + count("left"));
  EXPECT_NE(text.find("  foam         " + std::to_string(count("emitted")) + " made, "), std::string::npos);
  ASSERT_EQ(of("hot_jet.toml"), 0) << text;
  const auto heat = figures()["effects"]["heat"];
  EXPECT_GT(heat["held"].get<double>(), 0);
  EXPECT_EQ(heat["poured"], 0);
  EXPECT_NE(text.find(" K m_* held; 0 poured"), std::string::npos) << text;
}

}  // namespace
