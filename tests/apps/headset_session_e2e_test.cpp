/// vip-study run --display openxr: whole sessions of observers in the simulated headset, read from its own
/// log.
#include <map>
#include <sstream>

#include "tests/apps/headset_runs.hpp"

namespace apps {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

/// In how many slots each image was on, in order; black between two is left out.
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

class HeadsetSessionE2e : public test::HeadsetRuns {
 protected:
  void SetUp() override { bake_dam(dam_, 60); }

  /// The pilot's protocol with these means and standard deviations, played although some are approximate.
  std::string pilot(const std::string& means, const std::string& sds) {
    std::string text = base::read_file(base::find_input("protocols/ptpe_pilot.toml"), 1 << 20);
    const auto set = [&](const std::string& key, const std::string& value) {
      const auto at = text.find("\n" + key + " = ") + 1;
      text.replace(at, text.find('\n', at) - at, key + " = " + value);
    };
    set("n_star", R"(["64"])");
    set("mean_fps", means);
    set("sd_fps", sds);
    set("accept_approximate", "true");
    base::write_file_atomically(folder_ / "pilot.toml", text);
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
  std::map<int, int> pictures;  // by slots
  for (const int hold : holds_of(calls())) ++pictures[hold];
  EXPECT_EQ(pictures, (std::map<int, int>{{9, 10}, {3, 30}}));

  const std::string first = calls();
  database_ = folder_ / ("study" + std::to_string(++databases_) + ".db");
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
  for (const char* trouble : {"at=400:focus/0,460:focus/1", "at=150:focus/0,900:focus/1", "at=400:off/1",
                              "at=400:recentre/20", "at=400:rate/120"}) {
    database_ = folder_ / ("study" + std::to_string(++databases_) + ".db");
    const auto ended = session(trouble, protocol, "2");
    ASSERT_EQ(ended.exit_code, 0) << trouble << ": " << ended.err;
    EXPECT_THAT(ended.out, HasSubstr("showings: 2, 1 of them count, 1 cut short; timing: 1 pass")) << trouble;
  }
}

/// 72 Hz shows 10 frames/s approximately alone: intervals of 90 Hz would lie beside its slots, and be late.
TEST_F(HeadsetSessionE2e, AfterAChangeOfTheRateATrialsIntervalsAreComputedAnew) {
  const auto ended = session("at=400:rate/72", pilot("[10]", "[0]"), "2");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("1 cut short; timing: 0 pass, 1 degraded"));
  const std::string in_time = "    10      0       1   10.000   0.000    0.514   0.514       0    0.000";
  EXPECT_THAT(ended.out, HasSubstr(in_time));
  // In the black before the stimulus, too.
  database_ = folder_ / "black.db";
  const auto black = session("at=150:rate/72", pilot("[10]", "[0]"), "2");
  EXPECT_THAT(black.out, HasSubstr(in_time));
}

TEST_F(HeadsetSessionE2e, ALostSessionIsToldAndContinued) {
  const std::string protocol = pilot("[10]", "[0]");
  for (const char* trouble : {"at=400:lost", "at=400:instance_lost", "at=400:exit"}) {
    database_ = folder_ / ("study" + std::to_string(++databases_) + ".db");
    const auto ended = session(trouble, protocol, "2");
    EXPECT_EQ(ended.exit_code, 1) << trouble << ended.out;
    EXPECT_THAT(ended.err, HasSubstr("vip-study resume")) << trouble;
    const auto again = study("size=32x32", {"resume", "--db", database_});
    EXPECT_EQ(again.exit_code, 0) << trouble << ": " << again.err;
    EXPECT_THAT(again.out, HasSubstr("1 of 1 trials answered")) << trouble;
  }
}

TEST_F(HeadsetSessionE2e, DroppedSlotsMakeAFrameLate) {
  const auto ended = session("at=400:drop/4", pilot("[30]", "[0]"), "2");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, Not(HasSubstr("1 of 1 trials pass")));
}

TEST_F(HeadsetSessionE2e, LiveFluidRunsInRealTime) {
  const std::string protocol = pilot("[10]", "[0]");
  const auto ended = study("size=32x32;clock=real;rates=20;rate=20",
                           {"run", protocol, "--db", database_, "--observer", "random", "--display", "openxr",
                            "--clock", "real", "--participants", "1", "--trial-seconds", "1"});
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
  EXPECT_THAT(flat.err, HasSubstr("which two eyes would see flat"));
  EXPECT_FALSE(fs::exists(database_));
}

}  // namespace
}  // namespace apps
