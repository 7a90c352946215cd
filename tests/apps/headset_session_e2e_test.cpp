/// vip-study run --display openxr: whole sessions of observers in the simulated headset, checked in its own
/// log.
#include <map>
#include <sstream>

#include "libstudy/display/cut_cause.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "tests/apps/headset_runs.hpp"
#include "tests/common/protocols.hpp"
#include "tests/libstudy/permission_fixture.hpp"

namespace apps {
namespace {

namespace fs = std::filesystem;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// Number of slots of each image, in order. Black frames are left out.
std::vector<int> holds_of(const std::string& log) {
  std::vector<int> holds;
  std::string last;
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("frame ")) continue;
    const auto at = line.find("| shows ");
    const std::string image = at == std::string::npos ? "" : line.substr(at);
    const bool black = line.find(" layers 0 ") != std::string::npos;
    if (!black && (image != last || holds.empty())) holds.push_back(0);
    if (!black) ++holds.back();
    last = black ? "" : image;
  }
  return holds;
}

/// Number of frames without a layer that follow the last log line starting with `line`.
int black_frames_after(const std::string& log, const std::string& line) {
  int black = 0;
  std::istringstream rest(log.substr(log.rfind("\n" + line) + 1));
  for (std::string one; std::getline(rest, one);) {
    if (!one.starts_with("frame ")) continue;
    if (one.find(" layers 0") == std::string::npos) break;
    ++black;
  }
  return black;
}

class HeadsetSessionE2e : public test::HeadsetRuns {
 protected:
  void SetUp() override { bake_dam(dam_, 60); }

  /// The pilot's protocol with these means and standard deviations of the frame rate. It is played although
  /// the display can show some of them only approximately.
  std::string pilot(const std::string& means, const std::string& sds) {
    base::write_file_atomically(
        folder_ / "pilot.toml",
        test::with_keys(
            test::shipped_text("ptpe_pilot"),
            {{"n_star", "[\"64\"]"}, {"mean_fps", means}, {"sd_fps", sds}, {"accept_approximate", "true"}}));
    return folder_ / "pilot.toml";
  }

  test::Ended session(const std::string& profile, const std::string& protocol, const std::string& seconds,
                      const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"run",
                                       protocol,
                                       "--db",
                                       database_,
                                       "--observer",
                                       "ptpe:a=24,b=0.02",
                                       "--display",
                                       "openxr",
                                       "--clock",
                                       "virtual",
                                       "--stimulus",
                                       dam_,
                                       "--participants",
                                       "1",
                                       "--trial-seconds",
                                       seconds};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return study("size=32x32;" + profile, arguments);
  }

  /// pilot() that needs this refresh rate.
  std::string pilot_at_90() {
    const std::string held = pilot("[10]", "[0]");
    base::write_file_atomically(held, base::read_file(held, 1 << 20) + "\n[headset]\nrefresh_hz = 90\n");
    return held;
  }

  void next_database() { database_ = folder_ / ("study" + std::to_string(++databases_) + ".db"); }
  std::int64_t count(const std::string& rows) const {
    return study::sqlite::Connection(database_, study::sqlite::Open::Read)
        .integer("SELECT count(*) FROM " + rows);
  }
  std::string notes() const {
    study::sqlite::Connection database(database_, study::sqlite::Open::Read);
    study::sqlite::Statement row(database, "SELECT group_concat(words, '; ') FROM note");
    row.step();
    return row.text(0);
  }
  /// Ten frames/s for 3 s at 20 Hz. The trial is shown in about the slots 90 to 150.
  test::Ended real_session(const std::string& profile) {
    return study(
        real_profile + ";" + profile,
        {"run", pilot("[10]", "[0]"), "--db", database_, "--observer", "random", "--display", "openxr",
         "--clock", "real", "--stimulus", dam_, "--participants", "1", "--trial-seconds", "3"});
  }

  std::vector<std::string> column(const std::string& sql) const {
    return study::test::column(database_, sql);
  }
  /// The refresh rates of the rows of headset, as the runtime told them and, rounded, as they were measured.
  std::vector<std::string> rates() const {
    return column(
        "SELECT coalesce(refresh_told_hz, 'untold') || ' ' || coalesce(round(refresh_measured_hz, "
        "1), 'unmeasured') FROM headset ORDER BY headset_id");
  }
  std::vector<std::string> causes() const {
    return column("SELECT detail FROM event WHERE kind = 'trial interrupted' ORDER BY event_id");
  }

  void lose_session_in_real_time(const std::string& trouble) {
    const auto ended = real_session("at=115:" + trouble);
    ASSERT_EQ(ended.exit_code, 0) << ended.err;
    EXPECT_THAT(ended.out, HasSubstr("1 of 1 trials answered"));
    EXPECT_EQ(count("note WHERE words LIKE '%lost the session%'"), 1);
    EXPECT_EQ(count("presentation WHERE state = 'interrupted'"), 1);
    EXPECT_EQ(count("presentation WHERE state = 'played'"), 1);
    EXPECT_GT(black_frames_after(calls(), "xrBeginSession"), 50);
  }

  /// A call of xrWaitFrame that hangs ends the program, and nothing is lost.
  void hang(bool real) {
    const auto ended =
        real ? real_session("at=115:hang/60") : session("at=850:hang/60", pilot("[10, 30]", "[0]"), "2");
    EXPECT_EQ(ended.exit_code, 1) << ended.out;
    EXPECT_THAT(ended.err, HasSubstr("the runtime has let no frame begin for 10 s\n  mend: "));
    EXPECT_EQ(ended.err.find("mend: "), ended.err.rfind("mend: ")) << "one error: " << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("vip-study resume"));
    EXPECT_EQ(count("response WHERE attempt > 0"), real ? 0 : 1);
    EXPECT_THAT(causes(), ElementsAre(words_of(study::CutCause::Hang).happened));
    EXPECT_EQ(count("presentation WHERE state = 'interrupted'"), 1);
    EXPECT_GT(count("frame JOIN presentation USING (presentation_id) WHERE state = 'interrupted'"), 3);
    const auto again = study(real ? real_profile : "size=32x32", {"resume", "--db", database_});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_THAT(again.out, HasSubstr(real ? "1 of 1 trials answered" : "2 of 2 trials answered"));
  }

  const std::string real_profile = "size=32x32;clock=real;rates=20;rate=20";
  const std::string dam_ = folder_ / "dam.bake";
  std::string database_ = folder_ / "study.db";
  int databases_ = 0;
};

TEST_F(HeadsetSessionE2e, EachPictureIsOnForTheSlotsOfItsSetting) {
  const std::string protocol = pilot("[10, 30]", "[0]");
  const auto ended = session("hash=1", protocol, "1");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(calls(), Not(HasSubstr("\nnote")));
  EXPECT_THAT(ended.out, HasSubstr("2 of 2 trials pass"));
  std::map<int, int> pictures;  // number of pictures by the slots that they last
  for (const int hold : holds_of(calls())) ++pictures[hold];
  EXPECT_EQ(pictures, (std::map<int, int>{{9, 10}, {3, 30}}));

  const std::string first = calls();
  next_database();
  ASSERT_EQ(session("hash=1", protocol, "1").exit_code, 0);
  EXPECT_EQ(calls(), first);
}

TEST_F(HeadsetSessionE2e, TheWholePilotRunsAndUnreachableSettingsAreFlagged) {
  const auto whole = session("head=walk", pilot("[10, 20, 30, 40, 50]", "[0, 5, 10, 15, 20]"), "1");
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_THAT(whole.out, HasSubstr("21 of 21 trials answered"));
  EXPECT_THAT(whole.out,
              HasSubstr("    30      0       1   30.000   0.000    0.000   0.000       0    0.000     1"));
  EXPECT_THAT(whole.out, HasSubstr(" C     FAIL"));
}

TEST_F(HeadsetSessionE2e, WhatCouldNotBeSeenIsShownAgain) {
  const std::string protocol = pilot("[10]", "[0]");
  for (const char* trouble :
       {"at=400:focus/0,460:focus/1", "at=150:focus/0,900:focus/1", "at=400:off/1", "at=400:recentre/20",
        "at=400:rate/120", "presence=1;at=400:worn/0,460:worn/1"}) {
    next_database();
    const auto ended = session(trouble, protocol, "2");
    ASSERT_EQ(ended.exit_code, 0) << trouble << ": " << ended.err;
    EXPECT_THAT(ended.out, HasSubstr("showings: 2, 1 of them count, 1 cut short; timing: 1 pass")) << trouble;
  }
}

TEST_F(HeadsetSessionE2e, ReportsThatNobodyWearsTheHeadsetCutTheTrialUnlessTheyAreIgnored) {
  const std::string off = "presence=1;at=400:worn/0,700:worn/1";
  const auto ended = session(off, pilot("[10]", "[0]"), "2");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(notes(), HasSubstr("the headset was taken off"));
  next_database();
  const auto ignored = session(off, pilot("[10]", "[0]"), "2", {"--ignore-presence"});
  ASSERT_EQ(ignored.exit_code, 0) << ignored.err;
  EXPECT_THAT(ignored.out, HasSubstr("showings: 1, 1 of them count, 0 cut short"));
}

/// The rate falls from 90 to 72 Hz, which shows 10 frames/s only approximately. Intervals that were computed
/// for 90 Hz would not fit the new slots, and the frames would be late.
TEST_F(HeadsetSessionE2e, AfterAChangeOfTheRateATrialsIntervalsAreComputedAnew) {
  const auto ended = session("at=400:rate/72", pilot("[10]", "[0]"), "2");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("1 cut short; timing: 0 pass, 1 degraded"));
  const std::string in_time = "    10      0       1   10.000   0.000    0.514   0.514       0    0.000";
  EXPECT_THAT(ended.out, HasSubstr(in_time));
  // Here the rate changes in the black before the stimulus.
  database_ = folder_ / "black.db";
  const auto black = session("at=150:rate/72", pilot("[10]", "[0]"), "2");
  EXPECT_THAT(black.out, HasSubstr(in_time));
}

/// The compositor or the program is slow, and the runtime has no event that says so.
TEST_F(HeadsetSessionE2e, SlotsAtHalfRateMakeFramesLateAndNeitherCutNorEndASession) {
  const auto ended =
      session("without=XR_FB_display_refresh_rate;at=400:skips/1,434:skips/0", pilot("[30]", "[0]"), "2");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("showings: 1, 1 of them count, 0 cut short; timing: 0 pass"));
  EXPECT_THAT(rates(), ElementsAre("untold 90.0"));
}

TEST_F(HeadsetSessionE2e, TheProtocolsRateIsHeld) {
  const auto back = session("at=400:rate/72", pilot_at_90(), "2");
  ASSERT_EQ(back.exit_code, 0) << back.err;
  EXPECT_THAT(back.out, HasSubstr("showings: 2, 1 of them count, 1 cut short; timing: 1 pass"));
  EXPECT_THAT(rates(), ElementsAre("90.0 90.0", "72.0 unmeasured", "90.0 90.0"));
  EXPECT_THAT(causes(),
              ElementsAre(StartsWith(
                  "the headset's refresh rate changed: the refresh rate changed from 90 to 72 Hz")));
}

TEST_F(HeadsetSessionE2e, ALostSessionIsMadeAnewAndItsTrialShownAgain) {
  const std::string protocol = pilot("[10]", "[0]");
  for (const char* trouble :
       {"at=400:lost/3", "at=400:lost_now", "positive=1;at=400:lost/5", "at=400:lost_now,400:unfound/3",
        "without=XR_KHR_convert_timespec_time;at=400:lost_now", "rates=90;wrong_periods=5;at=400:lost_now"}) {
    next_database();
    const auto ended = session(trouble, protocol, "2");
    ASSERT_EQ(ended.exit_code, 0) << trouble << ": " << ended.err;
    EXPECT_THAT(ended.out, HasSubstr("showings: 2, 1 of them count, 1 cut short; timing: 1 pass")) << trouble;
    EXPECT_EQ(count("note WHERE words LIKE '%lost the session: %made anew%'"), 1)
        << trouble << ": " << notes();
    EXPECT_EQ(count("event WHERE kind = 'headset'"), 2) << trouble;
    EXPECT_EQ(count("frame JOIN presentation USING (presentation_id) WHERE state = 'interrupted'"), 13);
    // No picture for the lost session appears in the new one: three seconds of black precede the repeated
    // trial.
    EXPECT_GT(black_frames_after(calls(), "xrBeginSession"), 260) << trouble;
  }
}

TEST_F(HeadsetSessionE2e, ASessionThatIsLostInTheBlackCutsNothingThatCanBeSeen) {
  const auto early = session("at=150:lost_now", pilot("[10]", "[0]"), "2");
  ASSERT_EQ(early.exit_code, 0) << early.err;
  EXPECT_THAT(early.out, HasSubstr("showings: 1, 1 of them count, 0 cut short; timing: 1 pass"));
  EXPECT_EQ(count("event WHERE kind = 'headset'"), 2);
  // If the rate changes too, or the session is back only after the stimulus is due, the trial starts again.
  for (const char* trouble : {"at=150:lost_now,151:rate/72", "at=300:lost_now"}) {
    next_database();
    const auto late = session(trouble, pilot("[10]", "[0]"), "2");
    ASSERT_EQ(late.exit_code, 0) << trouble << late.err;
    EXPECT_EQ(count("note WHERE words LIKE 'the headset%'"), 1) << trouble;
    EXPECT_EQ(count("presentation WHERE state = 'played' AND verdict <> 'fail'"), 1) << trouble;
  }
}

/// Slow tests: the runtime announces the loss of the session beforehand, xrWaitFrame hangs in real time, or
/// the refresh rate stays wrong.
class HeadsetSessionSlow : public HeadsetSessionE2e {};

TEST_F(HeadsetSessionE2e, ALostSessionIsMadeAnewInRealTime) { lose_session_in_real_time("lost_now"); }
TEST_F(HeadsetSessionSlow, ASessionThatWillBeLostIsMadeAnewInRealTime) {
  lose_session_in_real_time("lost/2");
}

/// A pause ends the command of a simulated person. The session can be resumed.
TEST_F(HeadsetSessionSlow, ARateThatStaysWrongPausesTheSession) {
  const auto stays = session("at=400:ignores_rate/1,400:rate/72", pilot_at_90(), "2");
  EXPECT_EQ(stays.exit_code, 1);
  EXPECT_THAT(stays.err, HasSubstr("does not settle at the protocol's refresh_hz = 90"));
  EXPECT_EQ(study("size=32x32", {"resume", "--db", database_}).exit_code, 0);
  EXPECT_EQ(count("presentation WHERE state = 'played'"), 1);
  next_database();
  const std::string exact = pilot("[10]", "[0]");
  ::test::replace_in(exact, "accept_approximate = true", "accept_approximate = false");
  const auto ended = session("at=400:rate/72", exact, "2");
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr("changed to 72 Hz, at which the trial cannot be shown"));
  EXPECT_THAT(rates(), ElementsAre("90.0 90.0", "72.0 72.0"));
}

TEST_F(HeadsetSessionE2e, WhatCannotBeMadeAnewIsToldAndContinued) {
  const std::string protocol = pilot("[10]", "[0]");
  struct Trouble {
    std::string trouble, says;
    study::CutCause cause;
  };
  using study::CutCause;
  for (const auto& [trouble, says, cause] : std::vector<Trouble>{
           {"at=400:instance_lost", "XR_ERROR_INSTANCE_LOST", CutCause::ServiceGone},
           {"at=400:exit", "asked the program to leave", CutCause::ServiceGone},
           {"at=400:lost_now,800:lost_now,1200:lost_now", "keeps losing the session", CutCause::SessionLost},
           {"at=400:lost_now,400:unfound/999", "within 10 s none could be made anew (OpenXR: the runtime",
            CutCause::SessionLost}}) {
    next_database();
    const auto ended = session(trouble, protocol, "2");
    EXPECT_EQ(ended.exit_code, 1) << trouble << ended.out;
    EXPECT_THAT(ended.err, HasSubstr(says)) << trouble;
    EXPECT_THAT(ended.err, HasSubstr("vip-study resume")) << trouble;
    EXPECT_THAT(causes(), Each(StartsWith(words_of(cause).happened))) << trouble;
    EXPECT_EQ(causes().size(), column("SELECT words FROM note").size()) << trouble << ": " << notes();
    EXPECT_EQ(rates().size(), 1u) << trouble;
    const auto again = study("size=32x32", {"resume", "--db", database_});
    EXPECT_EQ(again.exit_code, 0) << trouble << ": " << again.err;
    EXPECT_THAT(again.out, HasSubstr("1 of 1 trials answered")) << trouble;
  }
}

TEST_F(HeadsetSessionE2e, AWaitThatHangsEndsTheProgramAndNothingIsLost) { hang(false); }
/// As the test before it, but on the real clock, on which the session's waits for its slots take time too.
TEST_F(HeadsetSessionSlow, AWaitThatHangsInRealTimeEndsTheProgramAndNothingIsLost) { hang(true); }

/// The stimulus is on from frame 283 to frame 463; the event is scheduled at frame 350 or 150.
TEST_F(HeadsetSessionE2e, ARecentringCutsTheTrialInWhichItComesIntoForce) {
  const std::string protocol = pilot("[10]", "[0]");
  const std::string cut = "presentation JOIN frame USING (presentation_id) WHERE state = 'interrupted'";
  for (const auto& [trouble, shown] : {std::pair{"at=350:recentre/20;recentre_lead=0.5", 12},
                                       {"at=350:recentre/20;recentre_lead=1.7", 0},
                                       {"at=150:recentre/20;recentre_lead=2.2", 7}}) {
    next_database();
    const auto ended = session(trouble, protocol, "2");
    ASSERT_EQ(ended.exit_code, 0) << trouble << ": " << ended.err;
    EXPECT_EQ(count("presentation WHERE state = 'interrupted'"), shown > 0 ? 1 : 0) << trouble;
    EXPECT_NEAR(static_cast<double>(count(cut)), shown, 1) << trouble;
    EXPECT_THAT(ended.out, HasSubstr("timing: 1 pass")) << trouble;
  }
}

TEST_F(HeadsetSessionE2e, DroppedSlotsMakeAFrameLate) {
  const auto ended = session("at=400:drop/4", pilot("[30]", "[0]"), "2");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, Not(HasSubstr("1 of 1 trials pass")));
}

TEST_F(HeadsetSessionE2e, LiveFluidRunsInRealTime) {
  const std::string protocol = pilot("[10]", "[0]");
  const auto ended =
      study("size=32x32;clock=real;rates=20;rate=20",
            {"run", protocol, "--db", database_, "--observer", "random", "--display", "openxr", "--clock",
             "real", "--participants", "1", "--trial-seconds", "1", "--accept-slow"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("1 of 1 trials answered"));
  EXPECT_THAT(ended.out, HasSubstr(" C "));
  EXPECT_THAT(ended.err, HasSubstr("measuring 1 live stimulus in the headset"));
}

TEST_F(HeadsetSessionE2e, WhatCannotBeIsRefusedBeforeAnythingIsWritten) {
  const std::string protocol = pilot("[10]", "[0]");
  const auto refuse = [&](const std::string& profile, const std::vector<std::string>& more,
                          const std::string& says) {
    const auto ended = session(profile, protocol, "1", more);
    EXPECT_EQ(ended.exit_code, 1) << says;
    EXPECT_THAT(ended.err, HasSubstr(says));
    EXPECT_FALSE(fs::exists(database_)) << says;
  };
  refuse("headset=unavailable", {}, "no headset is connected");
  refuse("opaque=0", {}, "world");
  refuse("clock=real", {}, "use --clock real");
  refuse("", {"--gaze", "tracked"}, "the protocol does not ask");
  const std::string pictures = folder_ / "pictures.bake";
  const auto baked =
      test::run_program({bin + "/vip-study", "bake", "data/scenes/single_dam.toml", "--method", "HiRes",
                         "--n-star", "64", "--frames", "10", "--pictures", "64x36", "--out", pictures});
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  const auto flat =
      study("size=32x32", {"run", protocol, "--db", database_, "--observer", "random", "--display", "openxr",
                           "--clock", "virtual", "--stimulus", pictures});
  EXPECT_EQ(flat.exit_code, 1);
  EXPECT_THAT(flat.err, HasSubstr("which would look flat in a headset"));
  EXPECT_FALSE(fs::exists(database_));
}

}  // namespace
}  // namespace apps
