/// The stimuli of a protocol that are baked, that is computed beforehand, and the differences between the
/// header of a bake and a BakeOrder, which says what the bake should hold.
#include "libstudy/stimulus/bakes/session_bakes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "libstudy/check/rehearsal.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"
#include "tests/apps/study_test_support.hpp"
#include "tests/libsim/bake/make_bake.hpp"

namespace apps {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string with_fixation(const std::string& text) {
  return test::with_before(text, "participants = ", "gaze = \"fixation\"\n");
}

std::vector<study::PlannedStimulus> plan_of(const std::string& text) {
  return study::plan_bakes(study::parse_protocol(text, "test"));
}

std::int64_t baked(const std::vector<study::PlannedStimulus>& plan) {
  return std::count_if(plan.begin(), plan.end(), [](const auto& one) { return one.live.empty(); });
}

std::set<std::string> files(const std::vector<study::PlannedStimulus>& plan) {
  std::set<std::string> out;
  for (const auto& one : plan) {
    if (!one.file.empty()) out.insert(one.file);
  }
  return out;
}

TEST(BakePlan, MethodsThatFollowAFreeGazeRunLive) {
  const auto plan = plan_of(test::shipped_text("task1"));
  EXPECT_EQ(plan.size(), 30u);
  EXPECT_EQ(baked(plan), 12);
  EXPECT_EQ(files(plan).size(), 12u);
  for (const auto& one : plan) {
    const bool fixed = one.what.method == "LoRes" || one.what.method == "HiRes";
    EXPECT_EQ(one.live.empty(), fixed) << one.what.method;
    EXPECT_EQ(one.file.empty(), !fixed) << one.what.method;
  }
  EXPECT_EQ(plan.front().file, "single_dam_16k_LoRes.bake");
  EXPECT_EQ(plan.front().frames, std::llround(55.25 * 30));
}

TEST(BakePlan, UnderFixationAllAreBakedEachUnderItsName) {
  const auto plan = plan_of(with_fixation(test::shipped_text("task1")));
  EXPECT_EQ(baked(plan), 30);
  EXPECT_EQ(files(plan).size(), 30u);
}

TEST(BakePlan, OneBakeServesAllSettingsUnlessTauFollowsFromThem) {
  const std::string text = with_fixation(test::shipped_text("ptpe_pilot"));
  EXPECT_THAT(plan_of(text), ::testing::SizeIs(1));
  const auto plan =
      plan_of(test::replaced(text, "method = [\"HiRes\"]", "method = [\"Ours\", \"Ours-TSp\"]"));
  EXPECT_EQ(plan.size(), 1u + 21);
  EXPECT_EQ(files(plan).size(), plan.size());
  EXPECT_EQ(plan.front().cells.size(), 21u);
}

TEST(BakePlan, OneBakeServesAllTimingProfilesOfAStimulus) {
  const std::string text = test::shipped_text("hitches");
  const auto plan = plan_of(text);
  EXPECT_THAT(files(plan), ElementsAre("droplet_8k_HiRes.bake", "single_dam_8k_HiRes.bake"));
  for (const auto& one : plan) {
    EXPECT_EQ(one.cells.size(), 6u);
    EXPECT_EQ(one.frames, 240);
  }
  // An animation error shifts the content time of a frame, here to 8 ms beyond the end of the trial.
  const auto uneven = plan_of(test::shipped_text("trace_smoothed"));
  ASSERT_THAT(uneven, ::testing::SizeIs(1));
  EXPECT_EQ(uneven.front().frames, std::ceil(4.008 / 0.004166666666666667));
}

TEST(BakePlan, ABakePlayedFrameByFrameHoldsTheFramesOfEverySeed) {
  auto protocol = study::parse_protocol(
      test::replaced(test::shipped_text("hitches"), "mode = \"real_time\"", "mode = \"per_frame\""), "test");
  for (const double duration_s : {4.6, 4.8, 5.0, 5.2}) {
    study::override_trial_seconds(protocol, duration_s);
    for (const study::Cell& cell : protocol.design.cells) {
      const std::int64_t steps = study::content_steps(protocol, cell.setting, 0);
      for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const auto shown = study::compile_schedule(cell.setting, protocol.pacing, seed).intervals_s.size();
        EXPECT_LE(static_cast<std::int64_t>(shown), steps) << study::setting_name(cell.setting);
      }
    }
  }
}

TEST(BakePlan, WhatRunsAsFastAsItGoesIsNotBaked) {
  const std::string text =
      test::replaced(test::shipped_text("task1"), "timing = \"table2\"", "timing = \"native\"");
  EXPECT_EQ(baked(plan_of(with_fixation(text))), 0);
}

TEST(BakePlan, ScenesOfOneNameAreToldApart) {
  const auto plan =
      plan_of(test::replaced(test::shipped_text("ptpe_pilot"), "scene = [\"data/scenes/single_dam.toml\"]",
                             "scene = [\"a/dam.toml\", \"b/dam.toml\"]"));
  EXPECT_THAT(files(plan), ElementsAre("dam_32k_HiRes-2.bake", "dam_32k_HiRes.bake"));
}

TEST(BakePlan, EachSurfaceHasABakeOfItsOwn) {
  const auto plan = plan_of(test::shipped_text("surface"));
  EXPECT_EQ(baked(plan), 12);
  EXPECT_EQ(files(plan).size(), 12u);
  EXPECT_EQ(plan.front().file, "single_dam_32k_HiRes_spheres.bake");
  const auto protocol = study::parse_protocol(test::shipped_text("surface"), "test");
  EXPECT_EQ(study::order_of(protocol, plan.front(), {}).fluid.surface, "spheres");
  EXPECT_EQ(study::order_of(protocol, plan.back(), {}).fluid.surface, "ellipsoids");
}

study::BakeOrder order() {
  study::BakeOrder out;
  out.fluid.scene = base::resource("data/scenes/single_dam.toml");
  out.fluid.method = "Ours-TSp";
  out.fluid.n_star = "64";
  out.fluid.fixed_rate = sim::FrameRate{20, 5};
  out.fluid.viewing.visual_angle_deg = [](int, int) { return 30.0; };
  return out;
}

TEST(BakeOrder, WhatIsWantedDepartsInNothing) {
  EXPECT_THAT(study::fluid_departures(study::header_of(order()), study::header_of(order())), IsEmpty());
  EXPECT_THAT(study::view_departures(study::header_of(order()), study::header_of(order())), IsEmpty());
}

/// Differences between a bake whose order was changed by `change` and the unchanged order.
template <typename Change>
std::string departures_after(const Change& change, bool view = false) {
  study::BakeOrder other = order();
  change(other);
  const auto found = study::header_of(other), wanted = study::header_of(order());
  return base::joined(view ? study::view_departures(found, wanted) : study::fluid_departures(found, wanted));
}

TEST(BakeOrder, EveryDepartureOfTheFluidIsNamed) {
  const auto after = [](const auto& change) { return departures_after(change); };
  EXPECT_THAT(after([](study::BakeOrder& o) { o.fluid.scene = base::resource("data/scenes/faucet.toml"); }),
              HasSubstr("scene Faucet"));
  EXPECT_EQ(after([](study::BakeOrder& o) { o.fluid.method = "Ours"; }), "method Ours instead of Ours-TSp");
  EXPECT_EQ(after([](study::BakeOrder& o) { o.fluid.n_star = "128"; }), "n_* 128 instead of 64");
  EXPECT_EQ(after([](study::BakeOrder& o) { o.fluid.content_step_s = 0.01; }),
            "content step 0.01 s instead of 0.0166667 s");
  EXPECT_EQ(after([](study::BakeOrder& o) { o.frames = 599; }), "599 frames instead of 600");
  EXPECT_EQ(after([](study::BakeOrder& o) { o.frames = 601; }), "") << "more than are shown harm nothing";
  EXPECT_THAT(after([](study::BakeOrder& o) { o.fluid.fixed_rate->sd = 4; }),
              HasSubstr("tau of 20, 4 frames/s"));
  EXPECT_THAT(after([](study::BakeOrder& o) { o.fluid.model.a = 30; }), HasSubstr("a = 30"));
  EXPECT_EQ(after([](study::BakeOrder& o) { o.scene_gaze = true; }),
            "gaze along the scene's keys instead of gaze on the middle of the picture");
}

TEST(BakeOrder, PicturesOfAnotherSurfaceDepart) {
  const auto between = [](const std::string& found, const std::string& wanted) {
    study::BakeOrder a = order(), b = order();
    a.fluid.surface = found;
    b.fluid.surface = wanted;
    return base::joined(study::fluid_departures(study::header_of(a), study::header_of(b)));
  };
  const std::string drawn = "particles of a method that followed ";
  EXPECT_EQ(between("spheres", "ellipsoids"), drawn + "pictures of spheres instead of ellipsoids");
  EXPECT_EQ(between("ellipsoids", "spheres"), drawn + "pictures of ellipsoids instead of spheres");
  EXPECT_EQ(between("spheres", ""), drawn + "pictures of spheres instead of ellipsoids");
  EXPECT_EQ(between("", "ellipsoids"),
            drawn + "pictures of a surface that is not recorded instead of ellipsoids");
  for (const char* surface : {"", "ellipsoids", "spheres"}) EXPECT_EQ(between(surface, surface), "");
  EXPECT_EQ(between("ellipsoids", ""), "");
  // A bake of particles whose method follows no picture is drawn when it is shown.
  study::BakeOrder particles = order();
  particles.fluid.method = "HiRes";
  particles.fluid.surface = "spheres";
  EXPECT_EQ(study::header_of(particles).view.surface, "");
  EXPECT_EQ(sim::format_of(study::header_of(particles)), 4u);
}

TEST(BakeOrder, EveryDepartureOfThePictureIsNamed) {
  const auto after = [](const auto& change) { return departures_after(change, true); };
  EXPECT_EQ(after([](study::BakeOrder& o) { o.size = {640, 360}; }), "picture 640x360 instead of 1280x720");
  EXPECT_EQ(after([](study::BakeOrder& o) { o.fluid.viewing.true_angle = true; }),
            "camera angle 30 deg instead of 75 deg");
  EXPECT_EQ(after([](study::BakeOrder& o) { o.fluid.viewing = {}; }),
            "angle of the eye's view not known instead of 30 deg");
  EXPECT_EQ(after([](study::BakeOrder& o) { o.fluid.overview = true; }), "") << "no picture is kept";
}

TEST(BakeOrder, TauWithoutAFrameRateIsRefused) {
  study::BakeOrder other = order();
  other.fluid.fixed_rate.reset();
  try {
    study::header_of(other);
    FAIL() << "accepted";
  } catch (const base::Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("--rate MEAN,SD"));
  }
}

TEST(BakeOrder, ParticlesAloneOfAFreeObstacleAreRefused) {
  study::BakeOrder other = order();
  other.fluid.scene = base::resource("data/scenes/float.toml");
  try {
    study::header_of(other);
    FAIL() << "accepted";
  } catch (const base::Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("has free obstacles"));
  }
  other.pictures = true;
  EXPECT_EQ(study::header_of(other).scene_name, "Float");
}

/// A bake has its scene's meshes in it, so it needs no file beside it.
TEST(BakeOrder, HoldsTheTrianglesOfMeshes) {
  study::BakeOrder other = order();
  other.fluid.scene = base::resource("data/scenes/boat.toml");
  other.pictures = true;
  const sim::BakeHeader header = study::header_of(other);
  EXPECT_THAT(header.scene_text, HasSubstr("obj = '''\nv "));
  const sim::Scene scene = sim::baked_scene(header);
  EXPECT_EQ(scene.sha256, header.scene_sha256);
  EXPECT_EQ(sim::obstacles_in_words(scene.obstacles),
            sim::obstacles_in_words(sim::read_scene(other.fluid.scene).obstacles));
}

TEST(SessionBakes, PicturesOfAFreeObstacleArePlayedParticlesAloneAreNot) {
  const auto protocol = study::parse_protocol(
      test::with_keys(
          test::shipped_text("ptpe_pilot"),
          {{"scene", "[\"data/scenes/float.toml\"]"}, {"n_star", "[\"64\"]"}, {"duration_s", "0.5"}}),
      "test");
  const study::SessionLook look{{}, {32, 18}};
  const auto plan = study::plan_bakes(protocol);
  ASSERT_EQ(plan.size(), 1u);
  auto wanted = study::order_of(protocol, plan[0], look);
  wanted.pictures = true;
  sim::BakeHeader header = study::header_of(wanted);
  const sim::BakeHeader made = bake_test::header(header.frame_count, 32, 18);
  header.backend = made.backend;
  header.max_particles = made.max_particles;
  header.radius_by_level_m = made.radius_by_level_m;
  header.view.renderer = made.view.renderer;
  const test::TemporaryFolder folder;
  const auto write = [&](const std::string& name) {
    sim::BakeWriter writer(folder / name, header);
    for (std::int64_t i = 0; i < header.frame_count; ++i) {
      writer.add_frame(static_cast<double>(i) / 60, bake_test::particles(i, 2, 2, 2), {});
      if (header.has_pictures()) writer.add_picture(bake_test::picture(i, 32, 18));
    }
    writer.finish();
  };
  write(plan[0].file);
  for (const auto& path : {folder / "", folder / plan[0].file}) {
    const study::SessionBakes bakes(path, protocol, look);
    EXPECT_TRUE(bakes.whole());
    EXPECT_EQ(bakes.departure(), "");
  }
  header.picture_width_px = header.picture_height_px = 0;
  header.camera = "";
  write("particles.bake");
  EXPECT_THAT([&] { study::SessionBakes(folder / "particles.bake", protocol, look); },
              ::testing::ThrowsMessage<base::Error>(HasSubstr("has free obstacles")));
}

}  // namespace
}  // namespace apps
