#include "libsim/scene/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <filesystem>

#include "libsim/methods/preset.hpp"
#include "libsim/scene/extent.hpp"
#include "libsim/scene/fill.hpp"
#include "libsim/simulation.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace {

using sim::MethodKind;

sim::Scene dam() { return sim::read_scene("data/scenes/single_dam.toml"); }

std::string dam_text() { return base::read_file(base::resource("data/scenes/single_dam.toml"), 1 << 20); }

std::string error_of(const std::string& text) {
  try {
    sim::parse_scene(text, "scene.toml");
  } catch (const base::Error& error) {
    return error.what();
  }
  return "no error";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Scene, SingleDamHasTheNumbersOfItsDescription) {
  const auto scene = dam();
  EXPECT_EQ(scene.name, "SingleDam");
  EXPECT_NEAR(sim::resolution_of(scene, MethodKind::HiRes, 32768).spacing_m, 0.15, 1e-12);
  EXPECT_NEAR(sim::resolution_of(scene, MethodKind::LoRes, 32768).spacing_m, 0.3, 1e-12);
  EXPECT_EQ(scene.gaze.size(), 4u);
  EXPECT_NEAR(scene.overview.eye_m[2] - scene.overview.target_m[2], 3 * (15.3 - 6.4), 1e-12);
}

TEST(Scene, DeclaresWhatMustStayVisible) {
  const std::string box =
      "\n[[visible]]\nname = \"crown\"\nmin_m = [1.0, 0.0, 2.0]\nmax_m = [2.0, 3.0, 4.0]\n";
  const auto scene = sim::parse_scene(dam_text() + box, "scene.toml");
  ASSERT_EQ(scene.visible.size(), dam().visible.size() + 1);
  EXPECT_EQ(scene.visible.back().name, "crown");
  EXPECT_EQ(scene.visible.back().min_m[2], 2);
  EXPECT_EQ(scene.visible.back().max_m[1], 3);
  EXPECT_THAT(error_of(dam_text() + replaced(box, "2.0, 3.0", "1.0, 3.0")),
              testing::AllOf(testing::HasSubstr("max_m"), testing::HasSubstr("leaves the box empty")));
  EXPECT_THAT(error_of(dam_text() + replaced(box, "\"crown\"", "\"\"")),
              testing::HasSubstr("is empty or too long"));
}

TEST(Scene, RefusesANameOfTwoLines) {
  for (const std::string& text :
       {replaced(dam_text(), "name = \"SingleDam\"", "name = \"Single\\nDam\""),
        dam_text() +
            "\n[[visible]]\nname = \"a\\u0007b\"\nmin_m = [1.0, 0.0, 2.0]\nmax_m = [2.0, 3.0, 4.0]\n"})
    EXPECT_THAT(error_of(text),
                testing::AllOf(testing::HasSubstr("name"), testing::HasSubstr("holds a control character")));
}

TEST(Scene, SettlesForSecondsAtTheFrameRateOfTheFile) {
  const auto frames = [](const std::string& settling, const std::string& rate = "60.0") {
    const auto text = replaced(dam_text(), "settle_frames = 120", settling);
    return sim::parse_scene(replaced(text, "frames_per_s = 60.0", "frames_per_s = " + rate), "scene.toml")
        .settle_frames;
  };
  EXPECT_EQ(frames("settle_s = 2.0"), 120);
  EXPECT_EQ(frames("settle_s = 2.0", "1000.0"), 2000);
  EXPECT_EQ(frames("settle_s = 0.051"), 4) << "rounded up";
  for (int whole = 0; whole <= 600; whole += 6)  // in tenths of a second, which are no binary fractions
    EXPECT_EQ(frames("settle_s = " + std::to_string(whole / 60.0)), whole);
  const auto error = [](const std::string& settling) {
    return error_of(replaced(dam_text(), "settle_frames = 120", settling));
  };
  EXPECT_THAT(
      error("settle_frames = 120\nsettle_s = 2.0"),
      testing::AllOf(testing::HasSubstr("scene.toml:16:"), testing::HasSubstr("'water.settle_s'"),
                     testing::HasSubstr("together with settle_frames"), testing::HasSubstr("keep one")));
  EXPECT_THAT(error(""), testing::AllOf(testing::HasSubstr("neither settle_s nor settle_frames"),
                                        testing::HasSubstr("give one")));
  EXPECT_THAT(error("settle_s = 170.0"),
              testing::AllOf(testing::HasSubstr("makes 10200 frames"), testing::HasSubstr("at most 10000")));
  EXPECT_THAT(error("settle_s = -1.0"), testing::HasSubstr("out of range"));
}

TEST(Scene, SubstepsFollowTheRule) {
  const auto scene = dam();
  EXPECT_EQ(sim::substeps_of(scene, 4 * 1024), 2);
  EXPECT_EQ(sim::substeps_of(scene, 32 * 1024), 3);
  EXPECT_EQ(sim::substeps_of(scene, 128 * 1024), 4);
}

std::string extent_error(const sim::Scene& scene, MethodKind method, std::int64_t n_star) {
  try {
    sim::check_extent(scene, method, n_star, 4 * sim::resolution_of(scene, method, n_star).spacing_m);
  } catch (const base::Error& error) {
    return error.what();
  }
  return "";
}

TEST(Extent, EverySceneThatShipsIsComputedAtEverySize) {
  for (const auto& entry : std::filesystem::directory_iterator(base::resource("data/scenes"))) {
    const bool lists = base::read_file(entry.path(), 1 << 20).find("[[effect]]") != std::string::npos;
    if (lists && !sim::has_effects()) continue;
    const auto scene = sim::read_scene(entry.path());
    for (std::int64_t n_star = 64; n_star <= 4 << 20; n_star *= 2)
      for (const auto& traits : sim::all_methods())
        EXPECT_EQ(extent_error(scene, traits.kind, n_star), "") << entry.path() << " " << n_star;
  }
}

TEST(Extent, ATankThatIsAllAirIsRefused) {
  auto scene = dam();
  scene.tank_size_m = {1e4, 10, 1e4};
  const auto error = extent_error(scene, MethodKind::HiRes, 1024);
  EXPECT_THAT(error, testing::AllOf(testing::HasSubstr("SingleDam"), testing::HasSubstr("tank.size_m"),
                                    testing::HasSubstr("mend: make the tank smaller")));
  sim::SimulationOptions options;
  options.n_star = 1024;
  EXPECT_THROW(sim::make_simulation(scene, options), base::Error);
}

TEST(Extent, WaterThinnerThanAParticleIsRefused) {
  auto scene = dam();
  scene.tank_size_m = {1e4, 10, 1e4};
  scene.water.front().max_m = {1e4, 0.1, 1e4};
  const auto error = extent_error(scene, MethodKind::HiRes, 1024);
  EXPECT_THAT(error, testing::AllOf(testing::HasSubstr("water.max_m"), testing::HasSubstr("0.1 m thin"),
                                    testing::HasSubstr("--n-star")));
}

TEST(Extent, MoreSubstepsThanAnybodyWaitsForAreRefused) {
  auto scene = dam();
  scene.water.front().max_m = {0.1, 0.1, 0.1};
  scene.tank_size_m = {0.2, 0.2, 0.2};
  scene.v_ref_m_s = 1000;
  scene.frame_dt_s = 1;
  EXPECT_THAT(extent_error(scene, MethodKind::HiRes, 4 << 20),
              testing::AllOf(testing::HasSubstr("time.v_ref_m_s"), testing::HasSubstr("substeps")));
}

TEST(Extent, MoreMemoryThanThereIsIsRefusedWithBothNumbers) {
  EXPECT_NO_THROW(sim::check_memory(MethodKind::HiRes, 128 << 10, 4e9));
  EXPECT_NO_THROW(sim::check_memory(MethodKind::HiRes, 4 << 20, {}));
  EXPECT_THAT([] { sim::check_memory(MethodKind::HiRes, 4 << 20, 4e9); },
              testing::ThrowsMessage<base::Error>(testing::AllOf(
                  testing::HasSubstr("36.9 GB of memory, 4 GB are free"), testing::HasSubstr("--n-star"))));
  EXPECT_THROW(sim::check_memory(MethodKind::Ours, 256 << 10, 4e9), base::Error);
  ASSERT_TRUE(sim::available_memory_bytes());
  EXPECT_GT(*sim::available_memory_bytes(), 1e6);
}

TEST(Fill, HoldsExactCountsAndVolumeAtEveryResolution) {
  const auto scene = dam();
  for (const std::int64_t n_star : {512, 2048, 16384, 32768}) {
    for (const auto& traits : sim::all_methods()) {
      const auto method = traits.kind;
      const auto points = sim::fill_positions(scene, method, n_star);
      ASSERT_EQ(static_cast<std::int64_t>(points.size()), sim::particle_count(method, n_star));
      double top = 0;
      for (const auto& p : points) {
        ASSERT_GT(p[0], 0);
        ASSERT_LT(p[0], 9.6);
        ASSERT_LT(p[2], 12.8);
        top = std::max(top, p[1]);
      }
      // The last layer may be partial: the top lies within one layer of 7.2 m.
      const double d = sim::resolution_of(scene, method, n_star).spacing_m;
      EXPECT_NEAR(top, 7.2, 1.2 * d) << n_star;
    }
  }
}

TEST(Scene, ErrorsNameThePlaceAndTheMend) {
  const std::string text = dam_text();
  EXPECT_THAT(error_of(replaced(text, "gate = true", "gates = true")),
              testing::HasSubstr("'water.gate' is missing"));
  EXPECT_THAT(error_of(text + "\n[extra]\n"), testing::HasSubstr("'extra' is not a known key"));
  EXPECT_THAT(error_of(replaced(text, "frames_per_s = 60.0", "frames_per_s = \"60\"")),
              testing::HasSubstr("scene.toml:19:16"));
  EXPECT_THAT(error_of(replaced(text, "iterations = 4", "iterations = 0")),
              testing::HasSubstr("out of range"));
  EXPECT_THAT(error_of(replaced(text, "max_m = [9.6,", "max_m = [29.6,")),
              testing::HasSubstr("outside the tank"));
  EXPECT_THAT(error_of(text.substr(0, text.size() / 2)), testing::HasSubstr("scene.toml:"));
  EXPECT_THAT(error_of(replaced(text, "frame = 60", "frame = 0")), testing::HasSubstr("order the gaze keys"));
  for (const char* light :
       {"environment = \"space\"", "seed = -1", "seed = 0.5", "absorption_per_m = [1.0, 2.0]",
        "absorption_per_m = [1.0, 2.0, -3.0]", "shadow = 1", "lamp = 3"})
    EXPECT_THAT(error_of(text + "\n[light]\n" + light + "\n"), testing::HasSubstr("'light.")) << light;
  for (const char* seed : {"1000001", "9007199254740993", "9223372036854775807"})
    EXPECT_THAT(error_of(text + "\n[light]\nseed = " + seed + "\n"),
                testing::HasSubstr("out of range\n  mend: use a value in [0, 1000000]"))
        << seed;
  EXPECT_THAT(error_of(replaced(text, "7.2, 12.8", "nan, 12.8")), testing::HasSubstr("must be finite"));
  EXPECT_THAT(error_of(replaced(text, "checkpoints = [", "checkpoints = [1.5, ")),
              testing::HasSubstr("'checkpoints' holds a fraction"));
}

TEST(Method, CountsAreReadAsUsersWriteThem) {
  EXPECT_EQ(sim::parse_n_star("32k"), 32768);
  EXPECT_EQ(sim::parse_n_star("4096"), 4096);
  for (const char* bad : {"", "k", "-1", "32m", "1e6", "99999999999999999999", "0", "5000k"}) {
    EXPECT_THROW(sim::parse_n_star(bad), base::Error) << bad;
  }
  EXPECT_EQ(sim::parse_method("hires"), MethodKind::HiRes);
}

TEST(Method, FiveAreKnownByNameInAnyCase) {
  for (const auto& method : sim::all_methods()) {
    EXPECT_EQ(sim::traits_of(method.kind).kind, method.kind);
    std::string name = method.name;
    for (char& c : name) c = static_cast<char>(std::toupper(c));
    EXPECT_EQ(sim::parse_method(name), method.kind) << name;
  }
  EXPECT_EQ(sim::particle_count(MethodKind::LoRes, 64), 64);
  EXPECT_EQ(sim::particle_count(MethodKind::OursTsp, 64), 512);
  try {
    sim::parse_method("Best");
    FAIL() << "an unknown method was taken";
  } catch (const base::Error& error) {
    for (const auto& method : sim::all_methods()) EXPECT_THAT(error.what(), testing::HasSubstr(method.name));
  }
}

TEST(Preset, TwoAreKnownAndDiffer) {
  EXPECT_EQ(sim::parse_preset("Paper"), sim::Preset::Paper);
  EXPECT_EQ(sim::parse_preset("tuned"), sim::Preset::Tuned);
  EXPECT_THROW(sim::parse_preset("best"), base::Error);
  const auto paper = sim::readings_of(sim::Preset::Paper);
  const auto tuned = sim::readings_of(sim::Preset::Tuned);
  EXPECT_EQ(paper.thickness, sim::ThicknessWeight::Max);
  EXPECT_EQ(tuned.thickness, sim::ThicknessWeight::Min);
  EXPECT_LT(tuned.split_share, paper.split_share);
}

}  // namespace
