/// Gaze of a simulated headset's wearer: recorded only with consent, and followed by the fluid.
#include <cmath>
#include <numbers>

#include "libstudy/headset/headset_recorder.hpp"
#include "libstudy/stimulus/fluid_stimulus.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "tests/apps/headset_runs.hpp"
#include "tests/libstudy/permission_fixture.hpp"

namespace apps {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double degree = std::numbers::pi / 180;

class HeadsetGazeE2e : public test::HeadsetRuns {
 protected:
  void SetUp() override { bake_dam(dam_, 60); }

  /// Two showings of half a second after a consent page that asks for gaze, or does not.
  std::string protocol(bool asks_gaze = true) {
    base::write_file_atomically(folder_ / "asking.toml", test::asking_at_60(asks_gaze));
    return folder_ / "asking.toml";
  }

  /// consent: the answer to all questions, 0 or 1.
  test::Ended session(const std::string& profile, const std::string& gaze, int consent = 1,
                      const std::string& protocol_file = "") {
    fs::remove(database_);
    fs::remove(database_ + ".answers.jsonl");
    return study("size=32x32;" + profile,
                 {"run", protocol_file.empty() ? protocol() : protocol_file, "--db", database_, "--observer",
                  "constant:" + std::to_string(consent), "--display", "openxr", "--clock", "virtual",
                  "--stimulus", dam_, "--participants", "1", "--gaze", gaze});
  }
  std::int64_t count(const std::string& rows) {
    return study::sqlite::Connection(database_, study::sqlite::Open::Read)
        .integer("SELECT count(*) FROM " + rows);
  }

  const std::string dam_ = folder_ / "dam.bake", database_ = folder_ / "study.db";
};

TEST_F(HeadsetGazeE2e, TheTrackersSamplesAreKeptAtTheirOwnRate) {
  const auto ended = session("gaze_rate=40;look_yaw=10;yaw=30;pitch=15", "tracked");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  // Two showings of .5 s: 45 slots and 20 samples each.
  EXPECT_NEAR(static_cast<double>(count("slot WHERE should_render = 1")), 90, 4);
  EXPECT_EQ(count("head WHERE turn_tracked = 1"), count("slot"));
  EXPECT_NEAR(static_cast<double>(count("gaze")), 40, 3);
  EXPECT_EQ(count("gaze WHERE source <> 'tracker' OR NOT valid OR NOT tracked OR device_ns IS NULL"), 0);
  EXPECT_EQ(count("gaze a JOIN gaze b USING (presentation_id) WHERE b.sample_index = a.sample_index + 1 AND "
                  "abs(b.sampled_ns - a.sampled_ns - 25000000) > 1000"),
            0);
  // The gaze's direction is relative to the head: 10 degrees to the left, although the head is turned by 30.
  EXPECT_EQ(count("gaze WHERE abs(direction_x + " + std::to_string(std::sin(10 * degree)) +
                  ") > 1e-3 OR abs(direction_z + " + std::to_string(std::cos(10 * degree)) + ") > 1e-3"),
            0);
  EXPECT_EQ(count("head WHERE abs(quat_y - " +
                  std::to_string(std::sin(15 * degree) * std::cos(7.5 * degree)) + ") < 1e-3"),
            count("head"));
  EXPECT_EQ(count("gaze WHERE x BETWEEN 0.4 AND 0.6 AND y BETWEEN 0.4 AND 0.6"),
            count("gaze WHERE x IS NOT NULL"));
  EXPECT_GT(count("gaze WHERE x IS NOT NULL"), 30);
  EXPECT_EQ(count("headset WHERE runtime = 'Simulated runtime' AND eye_tracking AND times_convert AND "
                  "left_width_px = 32 AND abs(left_fov_left_deg + 52) < 1e-3 AND hold = 'image' AND blend = "
                  "'opaque'"),
            1);
  EXPECT_EQ(count("ipd WHERE abs(ipd_mm - 63) < 0.01"), 1);
  EXPECT_EQ(count("presentation WHERE gaze_source = 'tracked'"), 2);
}

TEST_F(HeadsetGazeE2e, WithoutConsentNothingOfEyesAndHeadIsKept) {
  const auto ended = session("", "tracked", 0);
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_GT(count("slot"), 80);
  EXPECT_EQ(count("gaze"), 0);
  EXPECT_EQ(count("head"), 0);
  EXPECT_EQ(count("presentation WHERE gaze_source = 'head'"), 2);
}

TEST_F(HeadsetGazeE2e, TheHeadStandsInAndTheTrackerIsNotAskedFor) {
  const auto ended = session("look_yaw=10", "head");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(calls(), Not(HasSubstr("XR_EXT_eye_gaze_interaction")));
  EXPECT_EQ(count("gaze WHERE source = 'head' AND direction_z = -1"), count("slot"));
  EXPECT_EQ(count("headset WHERE eye_tracking"), 0);
  EXPECT_EQ(count("session WHERE gaze_source = 'head'"), 1);
}

TEST_F(HeadsetGazeE2e, ATrackerThatIsNotThereOrMayNotBeReadIsRefusedBeforeAnythingIsWritten) {
  const auto none = session("gaze=0", "tracked");
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("offers no eye tracker"));
  EXPECT_FALSE(fs::exists(database_));
  const auto unasked = session("", "tracked", 1, protocol(false));
  EXPECT_EQ(unasked.exit_code, 1);
  EXPECT_THAT(unasked.err, HasSubstr("ask gaze_kept"));
  EXPECT_FALSE(fs::exists(database_));
}

TEST_F(HeadsetGazeE2e, EyesLostCutATrialAndAGuessIsOnlyRecorded) {
  for (const auto& [trouble, cut] :
       {std::pair{"gaze_valid", true}, {"gaze_tracked", false}, {"position", false}}) {
    const auto ended =
        session("at=45:" + std::string(trouble) + "/0,65:" + std::string(trouble) + "/1", "tracked");
    ASSERT_EQ(ended.exit_code, 0) << trouble << ended.err;
    EXPECT_EQ(count("presentation WHERE state = 'interrupted'"), cut ? 1 : 0) << trouble;
    EXPECT_EQ(count("note WHERE words LIKE '%lost the eyes%'"), cut ? 1 : 0) << trouble;
    const std::string rows = trouble == std::string("position") ? "head WHERE NOT place_tracked"
                             : cut                              ? "gaze WHERE NOT valid"
                                                                : "gaze WHERE valid AND NOT tracked";
    EXPECT_GT(count(rows), 5) << trouble;
  }
}

TEST_F(HeadsetGazeE2e, SamplesStandInOrderAlsoWhereTheEyesWereLost) {
  // Samples are late, then immediate, lost for three slots, and late again.
  const auto ended = session(
      "gaze_rate=200;gaze_age=40;at=48:gaze_age/0,52:gaze_valid/0,55:gaze_valid/1,55:gaze_age/40", "tracked");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_EQ(count("gaze WHERE NOT valid AND device_ns IS NULL"), 3);
  EXPECT_EQ(count("gaze WHERE valid"), count("gaze WHERE device_ns IS NOT NULL"));
  EXPECT_EQ(count("gaze a JOIN gaze b USING (presentation_id) WHERE b.sample_index = a.sample_index + 1 AND "
                  "b.sampled_ns < a.sampled_ns"),
            0);
}

TEST_F(HeadsetGazeE2e, ThePointOfGazeIsOnThePictureAsItWasDrawn) {
  const std::string file = protocol();
  base::write_file_atomically(file, base::read_file(file, 1 << 20) + "\n[headset]\nhold_margin_deg = 10\n");
  const auto still = session("look_yaw=10;look_pitch=-5", "tracked", 1, file);
  ASSERT_EQ(still.exit_code, 0) << still.err;
  // The left eye's field of view is -52 to 42 degrees horizontally and -50 to 46 vertically; the margin adds
  // 10 degrees on each side.
  const auto slope = [](double deg) { return std::tan(deg * degree); };
  const double down = slope(-5) / std::cos(10 * degree);
  const double x = (slope(-10) - slope(-62)) / (slope(52) - slope(-62));
  const double y = (slope(56) - down) / (slope(56) - slope(-60));
  EXPECT_GT(count("gaze WHERE x IS NOT NULL"), 80);
  EXPECT_EQ(count("gaze WHERE abs(x - " + std::to_string(x) + ") > 1e-3 OR abs(y - " + std::to_string(y) +
                  ") > 1e-3"),
            0);
  // The head turns and the picture stays: eyes that look straight ahead move over it. During black there is
  // no point of gaze.
  const auto turns = session("head=turn", "tracked", 1, file);
  ASSERT_EQ(turns.exit_code, 0) << turns.err;
  EXPECT_GT(count("(SELECT DISTINCT round(x, 4) FROM gaze WHERE x IS NOT NULL)"), 30);
  EXPECT_EQ(
      count("gaze g WHERE x IS NULL AND valid AND EXISTS (SELECT 1 FROM slot s WHERE "
            "s.presentation_id = g.presentation_id AND frame_index >= 1 AND s.predicted_ns < g.sampled_ns)"),
      0);
}

TEST_F(HeadsetGazeE2e, ATrackerIsValidatedAtNineTargets) {
  const std::string file = protocol();
  test::replace_in(file, "[[block]]\nkind = \"stimulus\"",
                   "[[block]]\nkind = \"gaze_validation\"\nid = \"look\"\nmax_accuracy_deg = "
                   "1\n\n[[block]]\nkind = \"stimulus\"");
  const auto good = session("look=page;targets=0.5:0.5;head=turn", "tracked", 1, file);
  ASSERT_EQ(good.exit_code, 0) << good.err;
  EXPECT_EQ(count("gaze_validation WHERE passed AND accuracy_deg < 0.5 AND valid > 60"), 9);
  EXPECT_EQ(count("presentation WHERE state = 'played'"), 2);
  // Targets are ahead of the head even after a recentring, or in a new session.
  const auto moved = session("look=page;targets=0.5:0.5;at=200:recentre/40,500:lost_now", "tracked", 1, file);
  ASSERT_EQ(moved.exit_code, 0) << moved.err;
  EXPECT_EQ(count("gaze_validation WHERE passed AND accuracy_deg < 0.5 AND valid > 60"), 9);
  EXPECT_EQ(count("event WHERE kind = 'headset'"), 2);
  const auto poor = session("look_yaw=0", "tracked", 1, file);
  EXPECT_EQ(poor.exit_code, 1);
  EXPECT_THAT(poor.err, HasSubstr("the eye tracker is off by"));
  EXPECT_EQ(count("gaze_validation WHERE NOT passed"), 27);
  // The outer targets are 10 degrees off, four of them on both axes.
  EXPECT_EQ(
      count("gaze_validation WHERE accuracy_deg BETWEEN 9 AND 11 OR accuracy_deg BETWEEN 13.5 AND 14.5"), 24);
  EXPECT_EQ(count("presentation"), 0);
}

/// Mean x of the particles of the finest level, m, in a live fluid that is shown to eyes that look this many
/// degrees to the left.
double fine_x(double look_yaw) {
  study::HeadsetChoice choice;
  choice.eye_gaze = true;
  study::HeadsetDisplay display(study::SlotDrive::Caller, choice);
  study::HeadsetClock clock(display);
  study::HeadsetRecorder recorder(display, study::GazeOrigin::Tracker);
  recorder.start();
  study::StimulusChoice stimulus;
  stimulus.scene = base::find_input("data/scenes/single_dam.toml");
  stimulus.method = "FovFluid";
  stimulus.n_star = "512";
  stimulus.backend = "cpu";
  stimulus.viewing.ray = [&] { return recorder.ray(); };
  const auto fluid = study::make_live_fluid(stimulus);
  fluid->start(0);
  for (int step = 1; step <= 12; ++step) {
    fluid->prepare(step);
    display.render(*fluid);
    display.present(clock.now_ns() + 11'000'000, clock);
  }
  const auto particles = fluid->simulation().read_state();
  int finest = 99;
  for (const auto& particle : particles) finest = std::min(finest, particle.level);
  double sum = 0;
  int fine = 0;
  for (const auto& particle : particles) {
    if (particle.level != finest) continue;
    sum += static_cast<double>(particle.x_m);
    ++fine;
  }
  EXPECT_LT(fine, static_cast<int>(particles.size())) << look_yaw;
  return sum / fine;
}

TEST_F(HeadsetGazeE2e, LevelsFollowTheScriptedGaze) {
  // The water is left of the camera, which is at x = 12.8 m and 9 m away.
  double places[2] = {};
  for (const int far : {0, 1}) {
    const int yaw = far ? 45 : 20;
    use_here("size=96x96;look_yaw=" + std::to_string(yaw));
    places[far] = fine_x(yaw);
  }
  EXPECT_GT(places[0], places[1] + 1) << "finer where one looks";
}

}  // namespace
}  // namespace apps
