/// vip-study headset, through the real loader, on a simulated runtime (tests/headset) and without one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stats/base/json.hpp"
#include "tests/apps/headset_runs.hpp"

namespace apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using HeadsetE2e = test::HeadsetRuns;

TEST_F(HeadsetE2e, SaysWhatTheRuntimeOffers) {
  const auto ended = on("name=Monado(XRT)");
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  for (const char* line :
       {"runtime     Monado(XRT) 1.2.3\n", "headset     Simulated headset\n",
        "pictures    2064 x 2208 px, 2064 x 2208 px\n", "refresh     72, 80, 90, 120 Hz, now 90 Hz\n",
        "blend       opaque\n", "head        rotation and position are tracked\n",
        "gaze        eye tracker\n", "evidence grade C\n",
        "formats     GL_SRGB8_ALPHA8, GL_RGBA16F, GL_RGBA8, GL_DEPTH_COMPONENT32F\n", "XR_EXTX_made_up"})
    EXPECT_THAT(ended.out, HasSubstr(line));
  EXPECT_THAT(calls(), HasSubstr("xrDestroySession"));
  EXPECT_THAT(calls(), HasSubstr("xrDestroyInstance"));
}

TEST_F(HeadsetE2e, SaysWhatIsMissing) {
  const auto ended =
      on("gaze=0;position=0;opaque=0;formats=linear_first;without=XR_KHR_convert_timespec_time,"
         "XR_FB_display_refresh_rate");
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  for (const char* line :
       {"gaze        none\n", "head        only rotation is tracked\n", "evidence grade D\n",
        "blend       the world shows through the picture\n", "refresh     not reported; it is measured",
        "formats     GL_RGBA16F, GL_RGBA8, GL_SRGB8_ALPHA8\n"})
    EXPECT_THAT(ended.out, HasSubstr(line));
  const auto no_egl = on("without=XR_MNDX_egl_enable");
  EXPECT_THAT(no_egl.out,
              HasSubstr("refresh     not known: OpenXR: the runtime does not offer XR_MNDX_egl_enable, "
                        "and there is no X display\n"));
  EXPECT_THAT(no_egl.out, Not(HasSubstr("formats ")));
}

TEST_F(HeadsetE2e, EyeTrackingThatIsNotOfferedIsNotAskedFor) {
  const auto ended = on("without=XR_EXT_eye_gaze_interaction");
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("gaze        none\n"));
}

TEST_F(HeadsetE2e, ARateAloneIsNotBelieved) {
  const auto ended = on("rates=90;rate=0");
  EXPECT_THAT(ended.out, HasSubstr("refresh     90 Hz\n"));
  EXPECT_THAT(calls(), Not(HasSubstr("xrGetDisplayRefreshRateFB")));
}

TEST_F(HeadsetE2e, APositiveCodeIsNoFailure) {
  const auto ended = on("positive=1");
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("72, 80, 90, 120 Hz, now 90 Hz"));
}

TEST_F(HeadsetE2e, SaysWhichSettingsOfAProtocolAreExact) {
  const std::string json = folder_ / "offer.json";
  const auto ended = on("rates=120,72,90", {"protocols/ptpe_pilot.toml", "--json", json});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  for (const char* line : {"at 72 Hz: 10 exact", "at 90 Hz: 14 exact", "at 120 Hz: 19 exact"})
    EXPECT_THAT(ended.out, HasSubstr(line));
  const auto read = base::Json::parse(base::read_file(json, 1 << 20));
  EXPECT_EQ(read["runtime"], "Simulated runtime");
  EXPECT_EQ(read["refresh_hz"], (base::Json{72, 90, 120}));
  EXPECT_EQ(read["eyes"].size(), 2u);
  ASSERT_EQ(read["protocol"].size(), 3u);
  EXPECT_EQ(read["protocol"][2]["exact"], 19);
}

TEST_F(HeadsetE2e, EachThingThatIsNotThereIsNamed) {
  struct Case {
    std::string profile, says;
  };
  for (const auto& [profile, says] :
       std::vector<Case>{{"headset=unavailable", "no headset is connected"},
                         {"headset=unsupported", "does not support headsets"},
                         {"stereo=0", "does not show a picture to each of two eyes"},
                         {"without=XR_KHR_opengl_enable", "does not offer XR_KHR_opengl_enable"}}) {
    const auto ended = on(profile);
    EXPECT_EQ(ended.exit_code, 1) << profile;
    EXPECT_THAT(ended.err, HasSubstr(says));
    EXPECT_THAT(ended.err, HasSubstr("mend: "));
    EXPECT_EQ(ended.out, "");
  }
}

TEST_F(HeadsetE2e, WithoutARuntimeOrALoaderItSaysWhich) {
  const auto no_runtime = run({"headset"}, {{"XR_RUNTIME_JSON", folder_ / "none.json"}});
  EXPECT_EQ(no_runtime.exit_code, 1);
  EXPECT_THAT(no_runtime.err, HasSubstr("no runtime answers"));
  EXPECT_THAT(no_runtime.err, HasSubstr("XR_RUNTIME_JSON"));
  const auto no_loader = run({"headset"}, {{"VIP_OPENXR_LOADER", "libnone.so.1"}});
  EXPECT_EQ(no_loader.exit_code, 1);
  EXPECT_THAT(no_loader.err, HasSubstr("there is no libnone.so.1 on this machine"));
  const auto other = run({"headset"}, {{"VIP_OPENXR_LOADER", "libm.so.6"}});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("libm.so.6 is no OpenXR loader"));
}

TEST_F(HeadsetE2e, TheBenchSplitsAFramesTime) {
  const std::string json = folder_ / "bench.json";
  const auto ended = run_program_in_headset({bin + "/vip-bench", "headset", "--n-star", "64", "--frames", "5",
                                             "--warm-up", "1", "--passes", "--json", json},
                                            "size=32x32");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  const auto figures = base::Json::parse(base::read_file(json, 1 << 20));
  const auto mean = [&](const char* stage) { return figures["stages"][stage]["mean_ms"].get<double>(); };
  EXPECT_NEAR(mean("whole"), mean("step") + mean("draw") + mean("hand_over"), 1e-6);
  EXPECT_GT(mean("step"), 0);
  for (const char* pass : {"splat small", "filter", "shade"}) {
    EXPECT_GT(figures["passes"][pass].get<double>(), 0) << pass;
    EXPECT_LT(figures["passes"][pass].get<double>(), figures["stages"]["draw"]["p99_ms"].get<double>());
  }
  EXPECT_EQ(figures["particles"], 512);
  EXPECT_THAT(ended.out, HasSubstr("512 particles, 5 frames"));
  EXPECT_THAT(calls(), Not(HasSubstr("BREACH")));
}

}  // namespace
}  // namespace apps
