#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "libsim/gl/png.hpp"
#include "libsim/ptpe/ptpe_file.hpp"
#include "libsim/scene/effects.hpp"
#include "libsim/setting/finite_water.hpp"
#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"
#include "tests/apps/small_dam.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/common/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;

using apps::test::Ended;

/// vip-view on a small dam: 64 particles, nothing to settle.
class ViewE2e : public ::testing::Test {
 protected:
  ViewE2e() { base::write_file_atomically(scene(), apps::test::small_dam); }

  std::string scene() const { return (folder / "dam.toml").string(); }

  Ended view(const std::string& arguments, const std::string& environment = "") const {
    return apps::test::run_shell("env -u DISPLAY -u WAYLAND_DISPLAY " + environment +
                                 " " VIP_BIN_DIR "/vip-view " + arguments);
  }

  Ended small_run(const std::string& more) const {
    return view("--headless " + scene() +
                " --method LoRes --n-star 64 --backend cpu --size 64x48 --frames 3 " + more);
  }

  /// Writes a fitted curve for --ptpe. Returns the file's path.
  std::string fitted() const {
    sim::PtpeFile file;
    file.model = {31.5, 0.035};
    file.a_ci = {30, 33};
    file.b_ci = {0.03, 0.04};
    file.n_participants = 16;
    file.protocol_sha256 = std::string(64, 'a');
    file.date_utc = base::utc_now();
    base::write_file_atomically(folder / "fitted.toml", sim::format_ptpe_file(file));
    return (folder / "fitted.toml").string();
  }

  test::TemporaryFolder folder;
};

TEST_F(ViewE2e, WritesEverySecondPicture) {
  const auto outcome = small_run("--every 2 --png " + (folder / "new/out").string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder / "new/out"))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"frame_0000.png", "frame_0002.png"}));
  const auto first = sim::read_png(folder / "new/out" / "frame_0000.png");
  const auto third = sim::read_png(folder / "new/out" / "frame_0002.png");
  EXPECT_EQ(first.width, 64);
  EXPECT_EQ(first.height, 48);
  EXPECT_NE(first.rgba, third.rgba);  // the water moved
}

TEST_F(ViewE2e, ASoundRunTellsOfNoGuard) {
  const auto outcome = small_run("");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
  EXPECT_EQ(outcome.out.find("guards stepped in"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find("first trouble"), std::string::npos) << outcome.out;
}

TEST(Guards, TellOfLayersThatANozzleDidNotPour) {
  EXPECT_EQ(
      sim::in_words(sim::GuardCounts{.nozzle_waited = 1}),
      "guards stepped in: 1 layer that a nozzle did not pour for want of water in the tank's corners or of "
      "room for particles");
}

TEST(Guards, TellOfNeighboursInOnePlaceAndNotOfPairs) {
  EXPECT_EQ(sim::in_words(sim::GuardCounts{.coincident_pairs = 2}),
            "guards stepped in: 2 neighbours in a particle's own place (counted in each projection)");
  EXPECT_EQ(sim::in_words(sim::GuardCounts{}), "");
}

// Two plates that together close the tank move down into the water, which can escape only through the gaps.
TEST_F(ViewE2e, ARunInWhichAGuardStepsInEndsWithOneLineOnStandardError) {
  std::string text = apps::test::small_dam;
  const auto put = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  put("format = 1", "format = 2");
  put("max_m = [1.0,", "max_m = [2.0,");
  for (const char* x : {"0.5", "1.5"})
    text += std::string("[[obstacle]]\nshape = \"box\"\ncentre_m = [") + x +
            ", 1.31, 0.5]\nsize_m = [0.99, 1.0, 0.99]\nmotion = \"swings\"\nway_m = [0.0, -0.6, 0.0]\n"
            "period_s = 1.2\n";
  base::write_file_atomically(scene(), text);
  const auto outcome =
      apps::test::run_program({VIP_BIN_DIR "/vip-view", "--headless", scene(), "--method", "HiRes",
                               "--n-star", "64", "--backend", "cpu", "--size", "64x48", "--frames", "20"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err,
              ::testing::ContainsRegex(
                  "dam.toml: guards stepped in: [0-9]+ particle-substeps braked by the limit on speed"));
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("; first trouble: frame "));
  const auto told = outcome.err.find("guards stepped in");
  EXPECT_EQ(outcome.err.find("guards stepped in", told + 1), std::string::npos) << outcome.err;
}

TEST_F(ViewE2e, PrintsTheReferenceOfSceneFiles) {
  const auto outcome = view("--reference");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out, base::read_file(VIP_TEST_DIR "/../docs/scenes.md", 1 << 20));
}

TEST_F(ViewE2e, ExplainsItsSchedule) {
  const auto outcome = small_run("--explain");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
  EXPECT_NE(outcome.out.find("density constraint"), std::string::npos) << outcome.out;
}

TEST_F(ViewE2e, LeavesOutTheEffectsThatAreTurnedOff) {
  NEEDS_EFFECTS;
  const std::string run =
      "--headless data/scenes/splash.toml --backend cpu --n-star 64 --frames 1 --size 64x48 --explain ";
  const auto all = view(run);
  ASSERT_EQ(all.exit_code, 0) << all.out;
  EXPECT_NE(all.out.find("the scene lists rate_per_s"), std::string::npos) << all.out;
  EXPECT_EQ(all.out.find("\nwith "), std::string::npos) << all.out;
  const auto without = view(run + "--effects-off air_drag");
  ASSERT_EQ(without.exit_code, 0) << without.out;
  EXPECT_EQ(without.out.find("the scene lists rate_per_s"), std::string::npos) << without.out;
  EXPECT_NE(without.out.find("\nwith no effects\n"), std::string::npos) << without.out;
  const auto wrong = view(run + "--effects-off magic");
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_NE(wrong.out.find("--effects-off magic"), std::string::npos) << wrong.out;
}

TEST_F(ViewE2e, LoadsAFittedModel) {
  const auto outcome = small_run("--ptpe " + fitted());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
  EXPECT_NE(outcome.out.find("a = 31.5000"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("tau = "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("over the last 2 frames"), std::string::npos) << outcome.out;
}

TEST_F(ViewE2e, DrawsOnlyWhatAPictureTheSolverOrTheMeasuredRateNeeds) {
  const auto run = [&](const std::string& method_and_more) {
    const auto ended =
        view("--headless " + scene() + " --n-star 64 --backend cpu --size 64x48 --frames 41 --every 40 " +
             "--png " + (folder / "out").string() + " --method " + method_and_more);
    EXPECT_EQ(ended.exit_code, 0) << ended.out;
    return ended.out;
  };
  const auto plain = run("LoRes"), rated = run("LoRes --ptpe " + fitted()), seen = run("Ours");
  EXPECT_NE(plain.find("2 of 41 frames were drawn: those of the pictures\n"), std::string::npos) << plain;
  EXPECT_NE(rated.find("31 of 41 frames were drawn: those of the pictures and the last 30, whose rate"),
            std::string::npos)
      << rated;
  EXPECT_EQ(seen.find("were drawn"), std::string::npos) << "saliency reads each picture\n" << seen;
  EXPECT_NE(seen.find("draw "), std::string::npos) << seen;
}

TEST_F(ViewE2e, BadInputIsOneErrorAndNoPicture) {
  base::write_file_atomically(folder / "a_file", "x");
  base::write_file_atomically(folder / "bad.toml", "format = 1\na = -3\n");
  const std::string out = (folder / "out").string();
  const std::string run = "--headless " + scene() + " --method LoRes --n-star 64 --frames 2 --png ";
  const std::vector<std::pair<std::string, std::string>> cases{
      {run + out + " --size 64x", "--size 64x"},
      {run + out + " --size 64x8", "--size 64x8"},
      {run + out + " --size 64x48x3", "--size 64x48x3"},
      {run + out + " --size 8192x8192", "2.7 GB of memory"},
      {run + (folder / "a_file").string(), "a_file"},
      {run + out + " --ptpe " + (folder / "bad.toml").string(), "bad.toml"},
      {run + out + " --backend gpu", "gpu"},
      {"--headless " + (folder / "none.toml").string() + " --png " + out, "none.toml"},
  };
  for (const auto& [arguments, named] : cases) {
    const auto outcome = view(arguments);
    EXPECT_EQ(outcome.exit_code, 1) << arguments;
    EXPECT_NE(outcome.out.find("error: "), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find(named), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("mend: "), std::string::npos) << outcome.out;
    EXPECT_TRUE(!fs::exists(out) || fs::is_empty(out)) << arguments;
  }
  EXPECT_EQ(view(run + out + " --camera nowhere").exit_code, 2);
}

TEST_F(ViewE2e, NoDisplayNamesHeadless) {
  const auto outcome = view(scene() + " --method LoRes --n-star 64 --backend cpu");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.out.find("--headless"), std::string::npos) << outcome.out;
}

TEST_F(ViewE2e, NoDriverIsAClearError) {
  const auto outcome = view("--headless " + scene(), "__EGL_VENDOR_LIBRARY_FILENAMES=/nowhere.json");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.out.find("libgl1-mesa-dri"), std::string::npos) << outcome.out;
}

TEST_F(ViewE2e, PaintsEachValueOverTheWater) {
  for (const std::string name : {"level", "speed", "density", "saliency", "manifold", "active"}) {
    const auto ended = view("--headless " + scene() +
                            " --method Ours-TSp --n-star 64 --frames 3 --size 64x48 --tau fixed:-6 "
                            "--overlay " +
                            name + " --png " + (folder / name).string());
    ASSERT_EQ(ended.exit_code, 0) << ended.out;
    EXPECT_NE(ended.out.find("paint  "), std::string::npos) << name << ended.out;
    EXPECT_TRUE(fs::exists(folder / name / "frame_0002.png")) << name;
  }
  const auto none = view("--headless " + scene() +
                         " --method LoRes --n-star 64 --frames 2 --size 64x48 --overlay manifold "
                         "--png " +
                         (folder / "none").string());
  EXPECT_EQ(none.exit_code, 0);
  EXPECT_NE(none.out.find("computes none"), std::string::npos) << none.out;
  const auto cold = small_run("--overlay temperature --png " + (folder / "cold").string());
  EXPECT_EQ(cold.exit_code, 0);
  EXPECT_NE(cold.out.find("temperature: heat is not listed, or off"), std::string::npos) << cold.out;
}

TEST_F(ViewE2e, PaintsTheTemperatureOfAHotJet) {
  NEEDS_EFFECTS;
  const auto ended = view(
      "--headless data/scenes/hot_jet.toml --backend cpu --n-star 64 --frames 3 --every 2 --size 64x48 "
      "--overlay none,temperature --png " +
      (folder / "hot").string());
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  EXPECT_NE(ended.out.find("temperature 293.15 to 353.15 K"), std::string::npos) << ended.out;
  // Number of yellow pixels: cold water and the room have none.
  const auto yellow = [&](const std::string& name) {
    const auto picture = sim::read_png(folder / "hot" / name);
    int count = 0;
    for (std::size_t i = 0; i + 3 < picture.rgba.size(); i += 4)
      count += picture.rgba[i] > 120 && picture.rgba[i] > picture.rgba[i + 2] + 60;
    return count;
  };
  EXPECT_EQ(yellow("frame_0002.png"), 0);
  EXPECT_GT(yellow("frame_0002_temperature.png"), 20);
}

TEST_F(ViewE2e, SeveralOverlaysMakeAPictureEach) {
  const auto ended = small_run("--overlay none,level --every 2 --png " + (folder / "both").string());
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  EXPECT_NE(ended.out.find("4 pictures"), std::string::npos) << ended.out;
  const auto plain = sim::read_png(folder / "both" / "frame_0002.png");
  const auto painted = sim::read_png(folder / "both" / "frame_0002_level.png");
  EXPECT_NE(plain.rgba, painted.rgba);
  const auto alone = small_run("--overlay none --every 2 --png " + (folder / "alone").string());
  ASSERT_EQ(alone.exit_code, 0) << alone.out;
  EXPECT_EQ(sim::read_png(folder / "alone" / "frame_0002.png").rgba, plain.rgba)
      << "the plain picture must not know of the painted one";
}

TEST_F(ViewE2e, AlphaAndIterationsReachTheFluid) {
  const auto two = small_run("--explain --iterations 7 --alpha 0.25");
  ASSERT_EQ(two.exit_code, 0) << two.out;
  EXPECT_NE(two.out.find("x 7 iterations"), std::string::npos) << two.out;
  EXPECT_EQ(small_run("--alpha 1.5").exit_code, 2);
  EXPECT_EQ(small_run("--iterations 0").exit_code, 2);
}

TEST_F(ViewE2e, RefusesUnknownOverlaysPresetsLevelsAndTau) {
  for (const std::string wrong : {"--overlay glow", "--overlay level,glow", "--overlay level,",
                                  "--preset best", "--levels 5", "--tau fixed:", "--method Theirs"}) {
    const auto ended = view("--headless " + scene() + " --n-star 64 --frames 1 " + wrong);
    EXPECT_EQ(ended.exit_code, 1) << wrong << ended.out;
    EXPECT_NE(ended.out.find("error"), std::string::npos) << wrong;
  }
}

}  // namespace
