/// vip-study run --display openxr with a person: the scripted hand, eyes and stick of the simulated headset
/// answer the pages.
#include <array>
#include <regex>
#include <sstream>

#include "libstudy/store/file/sqlite.hpp"
#include "tests/apps/headset_runs.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

/// Targets on the pages of the pilot, as fractions of the page from its left and its top. The first is "yes"
/// on the consent page, and "No, go on" or a score of 4 on a session's first page; the second is a score of
/// 4; the third is the button to go on.
const std::string pilot_targets = "targets=0.5:0.503,0.5:0.39,0.5:0.9";
const std::string by_ray = "point=page;hold=0.4;" + pilot_targets + ";";
const std::string by_dwell = "look=page;hold=1.2;blink_every=0.8;blink_length=0.1;" + pilot_targets + ";";

/// A session that makes no progress ends after this number of frames.
constexpr int most_frames = 4000;
std::string script_of(const std::string& events) {
  return "at=" + events + std::to_string(most_frames) + ":exit";
}

class HeadsetPersonE2e : public test::HeadsetRuns {
 protected:
  void SetUp() override { bake_dam(dam_, 30); }

  std::string pilot(const std::string& means, const std::string& seconds = "0.5") {
    trial_seconds_ = seconds;
    base::write_file_atomically(folder_ / "pilot.toml", test::short_protocol_at(means));
    return folder_ / "pilot.toml";
  }

  std::vector<std::string> arguments(const std::string& protocol, const std::vector<std::string>& more = {}) {
    std::vector<std::string> all{"run",
                                 protocol,
                                 "--db",
                                 database_,
                                 "--participant",
                                 "P01",
                                 "--display",
                                 "openxr",
                                 "--clock",
                                 "virtual",
                                 "--stimulus",
                                 dam_,
                                 "--trial-seconds",
                                 trial_seconds_,
                                 "--events"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  test::Ended session(const std::string& profile, const std::string& protocol,
                      const std::vector<std::string>& more = {}) {
    return study("size=32x32;" + profile, arguments(protocol, more));
  }

  /// The first column of all rows, in order.
  std::vector<std::string> column(const std::string& sql) const {
    study::sqlite::Connection database(database_, study::sqlite::Open::Read);
    study::sqlite::Statement row(database, sql);
    std::vector<std::string> all;
    while (row.step()) all.push_back(row.text(0));
    return all;
  }

  const std::string dam_ = folder_ / "dam.bake";
  std::string trial_seconds_ = "0.5";
  std::string database_ = folder_ / "study.db";
};

/// Widths of each quad of the log in degrees, for an eye 1.5 m in front of its middle.
std::set<int> page_widths(const std::string& log) {
  std::set<int> widths;
  const std::regex size(R"(\| quad .* size ([0-9.]+) )");
  std::istringstream lines(log);
  std::smatch found;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_search(line, found, size))
      widths.insert(static_cast<int>(std::lround(2 * std::atan(std::stod(found[1]) / 3) * 57.29578)));
  }
  return widths;
}

TEST_F(HeadsetPersonE2e, ThePilotIsAnsweredByARay) {
  const auto ended = session(by_ray + script_of(""), pilot("[10, 30]"));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("2 of 2 trials answered"));
  EXPECT_THAT(ended.out, HasSubstr("2 of 2 trials pass"));
  EXPECT_THAT(column("SELECT score FROM response ORDER BY response_id"),
              ::testing::ElementsAre("1", "4", "4"));
  EXPECT_THAT(column("SELECT DISTINCT input FROM response"), ::testing::ElementsAre("ray"));
  EXPECT_THAT(column("SELECT test_data FROM session"), ::testing::ElementsAre("1"));
  EXPECT_EQ(page_widths(calls()), std::set<int>{38});
}

TEST_F(HeadsetPersonE2e, ThePilotIsAnsweredByTheEyesAlone) {
  const auto ended = session(by_dwell + script_of(""), pilot("[10]"), {"--answer", "dwell"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("1 of 1 trials answered"));
  EXPECT_THAT(column("SELECT score FROM response ORDER BY response_id"), ::testing::ElementsAre("1", "4"));
  EXPECT_THAT(column("SELECT DISTINCT input FROM response"), ::testing::ElementsAre("dwell"));
}

/// The pilot with a reaction before each rating, and the rating on a line.
std::string with_line_and_reaction(std::string text) {
  text = test::replaced(text, "\"ask satisfaction\"", "\"ask fast\", \"ask satisfaction\"");
  text = test::replaced(text, "kind = \"scale\"", "kind = \"vas\"");
  text = test::replaced(text, "scale = [1, 7]", "");
  text = test::replaced(
      text, "{1 = \"very dissatisfied\", 4 = \"neutral\", 7 =", "{0 = \"very dissatisfied\", 100 =");
  const std::string reaction =
      "[[block.question]]\nid = \"fast\"\nkind = \"reaction\"\ntext = \"Now!\"\ntimeout_s = 1.5\n";
  return test::with_before(text, "[[block.question]]\nid = \"satisfaction\"", reaction);
}

TEST_F(HeadsetPersonE2e, ALineAndAReactionAreAnsweredByHandAndALineByTheEyes) {
  const std::string protocol = folder_ / "kinds.toml";
  base::write_file_atomically(protocol, with_line_and_reaction(test::short_protocol_at("[10]")));
  const std::string targets = "targets=0.5:0.503,0.3:0.39,0.5:0.9;";
  const std::string scores = "SELECT score FROM response ORDER BY response_id";
  const auto by_hand = session("point=page;hold=0.4;" + targets + script_of(""), protocol);
  ASSERT_EQ(by_hand.exit_code, 0) << by_hand.err;
  const auto hand = column(scores);
  EXPECT_EQ(column("SELECT r.response_time_s BETWEEN 0.01 AND 1.4 FROM response r JOIN question q USING "
                   "(question_id) WHERE q.code = 'fast'")
                .at(0),
            "1");
  database_ = folder_ / "eyes.db";
  const auto by_eyes =
      session("look=page;hold=1.2;blink_every=0.8;blink_length=0.1;" + targets + script_of(""), protocol,
              {"--answer", "dwell"});
  ASSERT_EQ(by_eyes.exit_code, 0) << by_eyes.err;
  const auto eyes = column(scores);
  ASSERT_EQ(hand.size(), 3u);
  ASSERT_EQ(eyes.size(), 3u);
  EXPECT_EQ(hand[1], "1");
  EXPECT_EQ(eyes[1], "0") << "eyes press nothing";
  EXPECT_NEAR(std::stod(hand[2]), 26, 3) << "0.3 of the page lies there on the line";
  EXPECT_NEAR(std::stod(eyes[2]), std::stod(hand[2]), 2);
}

TEST_F(HeadsetPersonE2e, AStickChoosesAndSelectIsEnter) {
  // The stick to the left moves to the last choice, a press of select chooses it, and the next press goes on.
  std::string script;
  for (int frame = 0; frame < most_frames; frame += 60) {
    for (const auto& [later, what] : std::vector<std::pair<int, std::string>>{{5, "thumb_x/-0.9"},
                                                                              {10, "thumb_x/0"},
                                                                              {20, "select/1"},
                                                                              {25, "select/0"},
                                                                              {40, "select/1"},
                                                                              {45, "select/0"}})
      script += std::to_string(frame + later) + ":" + what + ",";
  }
  const auto ended = session("controller=oculus/touch_controller;" + script_of(script), pilot("[10]"),
                             {"--answer", "stick"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(column("SELECT score FROM response ORDER BY response_id"), ::testing::ElementsAre("1", "7"));
  EXPECT_THAT(column("SELECT DISTINCT input FROM response"), ::testing::ElementsAre("stick"));
}

TEST_F(HeadsetPersonE2e, StopOnThePageEndsTheSession) {
  const auto ended =
      session("point=page;hold=0.4;targets=0.06:0.94,0.5:0.557,0.5:0.9;" + script_of(""), pilot("[10]"));
  EXPECT_EQ(ended.exit_code, 3) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("P01 stopped before the end"));
  EXPECT_THAT(ended.out, HasSubstr("showings: 0"));
}

TEST_F(HeadsetPersonE2e, MenuDuringAStimulusAsksAndTheTrialIsShownAgain) {
  const auto ended = session(by_ray + script_of("520:menu/1,640:menu/0,"), pilot("[10]", "3"));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("showings: 2, 1 of them count, 1 cut short"));
}

TEST_F(HeadsetPersonE2e, TimeAwayFromAPageIsNoResponseTime) {
  const std::string protocol = pilot("[10]"),
                    times = "SELECT response_time_s FROM response ORDER BY response_id";
  ASSERT_EQ(session(by_ray + script_of(""), protocol).exit_code, 0);
  const double usual_s = std::stod(column(times)[0]);
  for (const std::string away : {"230:focus/0,500:focus/1,", "230:off/3,"}) {
    database_ = folder_ / (away.substr(4, 3) + ".db");
    ASSERT_EQ(session(by_ray + script_of(away), protocol).exit_code, 0);
    const double away_s = std::stod(column(times)[0]);
    EXPECT_NE(away_s, usual_s) << away << "it was on this page";
    EXPECT_NEAR(away_s, usual_s, 1.3) << away << "of three s; the hand goes once more from target to target";
  }
}

/// One "frame" line of the runtime's log.
struct LoggedFrame {
  int number = 0;
  bool page = false, picture = false;
  double x = 0, z = 0;  ///< position of the page, m
};
std::vector<LoggedFrame> frames_of(const std::string& log) {
  std::vector<LoggedFrame> frames;
  const std::regex quad(R"(\| quad .* at ([-.0-9]+) [-.0-9]+ ([-.0-9]+) )");
  std::istringstream lines(log);
  std::smatch found;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("frame ")) continue;
    LoggedFrame& frame = frames.emplace_back();
    frame.number = std::stoi(line.substr(6));
    frame.picture = line.find("| projection ") != std::string::npos;
    frame.page = std::regex_search(line, found, quad);
    if (!frame.page) continue;
    frame.x = std::stod(found[1]);
    frame.z = std::stod(found[2]);
  }
  return frames;
}

/// Mean of all pixels, [0, 255].
double brightness(const sim::Image& image) {
  double sum = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) sum += image.rgba[i];
  return 4 * sum / static_cast<double>(image.rgba.size());
}

TEST_F(HeadsetPersonE2e, APageFadesAndNeverStandsBesideAStimulus) {
  const std::string protocol = pilot("[10]");
  ASSERT_EQ(session(by_ray + script_of(""), protocol).exit_code, 0);
  int pages = 0, pictures = 0, last_page = 0;
  for (const LoggedFrame& frame : frames_of(calls())) {
    EXPECT_FALSE(frame.page && frame.picture) << frame.number;
    pages += frame.page;
    pictures += frame.picture;
    if (frame.page && pictures == 0) last_page = frame.number;
  }
  EXPECT_GT(pages, 100);
  EXPECT_EQ(pictures, 45);
  // Runs the session again and writes images of the page that fades before the stimulus. It fades over .2 s,
  // 18 frames.
  std::string dump = "dump=" + std::to_string(last_page - 24);
  for (int frame = last_page - 23; frame <= last_page; ++frame) dump += "," + std::to_string(frame);
  database_ = folder_ / "fading.db";
  ASSERT_EQ(session(dump + ";" + by_ray + script_of(""), protocol).exit_code, 0);
  double before = brightness(picture(last_page - 24, "quad"));
  EXPECT_GT(before, 5);
  EXPECT_NEAR(brightness(picture(last_page - 20, "quad")), before, 0.01 * before);
  const double half = brightness(picture(last_page - 9, "quad"));
  EXPECT_GT(half, 0.2 * before);
  EXPECT_LT(half, 0.8 * before);
  for (int frame = last_page - 16; frame <= last_page; ++frame) {
    const double now = brightness(picture(frame, "quad"));
    EXPECT_LT(now, before) << frame;
    before = now;
  }
  EXPECT_LT(before, 0.5);
}

TEST_F(HeadsetPersonE2e, APageStandsAheadAlsoAfterARecentring) {
  // The origin turns to the left, so the head then looks 30 degrees to its right, and the page is there too.
  const auto ended = session(by_ray + script_of("200:recentre/30,"), pilot("[10]"));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  bool before = false, after = false;
  for (const LoggedFrame& frame : frames_of(calls())) {
    if (!frame.page) continue;
    const bool turned = frame.number > 200;
    (turned ? after : before) = true;
    EXPECT_NEAR(frame.x, turned ? 0.75 : 0, 1e-3) << frame.number;
    EXPECT_NEAR(frame.z, turned ? -1.299 : -1.5, 1e-3) << frame.number;
  }
  EXPECT_TRUE(before && after);
}

TEST_F(HeadsetPersonE2e, ASessionThatIsLostComesBackWithItsPage) {
  for (const char* trouble : {"200:lost/2,", "470:lost_now,"}) {  // on the first page, in the stimulus
    database_ = folder_ / (std::string(1, *trouble) + ".db");
    const auto ended = session(by_ray + script_of(trouble), pilot("[10]", "3"));
    ASSERT_EQ(ended.exit_code, 0) << trouble << ended.err;
    EXPECT_THAT(ended.out, HasSubstr("1 of 1 trials answered")) << trouble;
    EXPECT_THAT(column("SELECT detail FROM event WHERE kind = 'headset' ORDER BY event_id"),
                ::testing::ElementsAre("the headset's software lost the session", "a session was made anew"));
    EXPECT_THAT(column("SELECT score FROM response ORDER BY response_id"), ::testing::ElementsAre("1", "4"));
    EXPECT_THAT(column("SELECT count(*) FROM presentation WHERE state = 'interrupted'"),
                ::testing::ElementsAre(*trouble == '2' ? "0" : "1"));
  }
}

TEST_F(HeadsetPersonE2e, AKilledSessionIsResumedAndNothingIsAskedTwice) {
  const std::string protocol = pilot("[10, 30]");
  const auto environment = simulated("size=32x32;" + by_ray + script_of(""));
  std::set<std::pair<std::string, int>> before;
  {
    auto all = arguments(protocol);
    all.insert(all.begin(), bin + "/vip-study");
    test::Process killed(all, [&] { prepare(environment); });
    while (const auto line = killed.read_line()) {
      if (line->starts_with("done P01 2 ")) break;  // the first trial is done; the second is running
    }
    killed.send(SIGKILL);
    EXPECT_EQ(killed.wait().signal, SIGKILL);
    before = test::done_in(database_);
  }
  ASSERT_GE(before.size(), 3u);
  const auto resumed =
      study("size=32x32;" + by_ray + script_of(""), {"resume", "--db", database_, "--events"});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.out, HasSubstr("2 of 2 trials answered"));
  for (const auto& key : test::acknowledged(resumed.out)) EXPECT_FALSE(before.count(key)) << key.second;
  EXPECT_EQ(test::answers_in(database_).size(), 3u);
}

TEST_F(HeadsetPersonE2e, TheConsoleSteersFromItsTerminal) {
  std::string line = "printf 'nthe door opened\\n' | " + bin + "/vip-study";
  for (const std::string& one : arguments(pilot("[10]"), {"--console"})) line += " '" + one + "'";
  const auto environment = simulated("size=32x32;" + by_ray + script_of(""));
  const auto ended = test::run_program({"/bin/sh", "-c", line}, [&] { prepare(environment); });
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("noted: the door opened"));
  EXPECT_THAT(ended.out, HasSubstr("1 of 1 trials answered"));
}

TEST_F(HeadsetPersonE2e, WhatAPersonCannotAnswerWithIsRefusedBeforeAnythingIsWritten) {
  for (const auto& [ways, says] : std::vector<std::pair<std::string, std::string>>{
           {"nod", "'nod' is not known"}, {"ray,dwell", "both point"}}) {
    const auto ended = session(by_ray, pilot("[10]"), {"--answer", ways});
    EXPECT_EQ(ended.exit_code, 1);
    EXPECT_THAT(ended.err, HasSubstr(says));
    EXPECT_FALSE(fs::exists(database_));
  }
  const auto console = session(by_ray, pilot("[10]"), {"--answer", "keyboard", "--console"});
  EXPECT_THAT(console.err, HasSubstr("the console uses the terminal's keys"));
  EXPECT_FALSE(fs::exists(database_));
  for (const char* way : {"ray", "stick", "ray,stick,keyboard"}) {
    const auto handless = session("controller=none", pilot("[10]"), {"--answer", way});
    EXPECT_EQ(handless.exit_code, 1);
    EXPECT_THAT(handless.err, HasSubstr("no controller and no tracked hand is active in the headset"));
    EXPECT_THAT(handless.err, HasSubstr("or use --answer dwell"));
    EXPECT_FALSE(fs::exists(database_));
  }
  const auto keyless = session(by_ray, pilot("[10]"), {"--answer", "keyboard"});
  EXPECT_THAT(keyless.err, HasSubstr("--answer: the program was not started in a terminal\n  mend: "));
  EXPECT_FALSE(fs::exists(database_));
  const auto observer = session(by_ray, pilot("[10]"), {"--answer", "ray", "--observer", "random"});
  EXPECT_THAT(observer.err, HasSubstr("is for a person in a headset"));
}

}  // namespace
}  // namespace apps
