/// Markers of vip-study run and resume, as a recording system gets them, and vip-study markers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <sstream>
#include <utility>

#include "libstudy/markers/receiver.hpp"
#include "tests/apps/study_test_support.hpp"
#include "tests/libstudy/marker_receivers.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// Two trials of 0.1 s with one rating each.
std::string write_protocol(const fs::path& folder) {
  const std::string path = folder / "marked.toml";
  base::write_file_atomically(path, R"(format = 2
name = "marked"
version = "1.0"
language = "en"
participants = 2
[design]
scene = ["data/scenes/single_dam.toml"]
method = ["HiRes"]
n_star = ["16k"]
timing = "settings"
mean_fps = [20, 50]
sd_fps = [0]
duration_s = 0.1
order = "shuffle"
[pacing]
fps_min = 4
max_interval_ms = 250
[content]
mode = "per_frame"
content_step_s = 0.02
start_frame = 0
at_end = "hold"
[[block]]
kind = "stimulus"
id = "trials"
steps = ["black 0.05", "stimulus", "ask rating"]
[[block.question]]
id = "rating"
kind = "scale"
text = "How was it?"
scale = [1, 7]
)");
  return path;
}

std::vector<std::string> run_marked(const fs::path& folder, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{vip_study,   "run",           write_protocol(folder),
                                     "--db",      folder / "s.db", "--participant",
                                     "P01",       "--observer",    "random",
                                     "--display", "none",          "--gaze",
                                     "none",      "--events"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// The names of the events in lines of markers.
std::vector<std::string> events_of(const std::string& text) {
  std::istringstream lines(text);
  std::vector<std::string> events;
  for (std::string line; std::getline(lines, line);) events.push_back(line.substr(0, line.find(',')));
  return events;
}

TEST(VipStudyMarkersE2e, AKilledSessionGoesOnAndSoDoItsMarkers) {
  const TemporaryFolder folder;
  ::test::Listener listener;
  ::test::SerialLine box;
  const std::string tcp = "tcp:" + listener.port(), serial = "serial:" + box.path();
  {
    Process run(run_marked(folder.path(), {"--clock", "real", "--markers", tcp, "--markers", serial}));
    listener.accept();
    for (auto line = run.read_line(); line && !line->starts_with("done P01 0"); line = run.read_line()) {
    }
    listener.read_until("stimulus_onset,3,0,1");
    run.send(SIGKILL);
    run.wait();
  }
  const std::string before = listener.read_until("the end of the connection");
  EXPECT_THAT(events_of(before).front(), "event");
  const std::string again = "tcp:127.0.0.1:" + listener.port();  // another name of the same receiver
  const auto resumed = Process({vip_study, "resume", "--db", folder / "s.db", "--markers", again}).wait();
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.err, HasSubstr("sent markers to " + serial + ", and this command sends it none"));
  EXPECT_THAT(resumed.err, Not(HasSubstr("sent markers to " + tcp)));
  listener.accept();
  const std::string after = listener.read_until("session_end");
  EXPECT_THAT(events_of(after), ElementsAre("event", "session_begin", "trial_begin", "stimulus_onset",
                                            "question_shown", "answer_given", "trial_end", "session_end"));
  EXPECT_THAT(after, HasSubstr("trial_begin,129,0,1,2,"));  // the second showing of the trial at position 1
  EXPECT_THAT(resumed.out,
              HasSubstr("markers to " + again + ": 7 written, 0 lost; from event to completed write"));
  // Session begin, first trial; each byte between two zeros.
  EXPECT_EQ(box.read(8).substr(0, 8), std::string("\0\x40\0\x80\0\x03\0\x05", 8));
  // Stored are the onset of the first trial at both receivers, and that of the second trial, which was shown
  // after the kill.
  EXPECT_EQ(
      count_in(folder / "s.db",
               "SELECT count(*) FROM marker m JOIN presentation p ON m.clock_ns BETWEEN p.start_ns AND "
               "p.end_ns JOIN trial USING (trial_id) JOIN unit u ON u.trial_id = p.trial_id WHERE m.event = "
               "'stimulus_onset' AND u.position = m.position AND p.attempt = m.attempt"),
      3);
  for (const char* code : {"P01", "random"}) EXPECT_THAT(before + after, Not(HasSubstr(code)));
}

TEST(VipStudyMarkersE2e, AReceiverThatHangsUpEndsNoSession) {
  const TemporaryFolder folder;
  auto listener = std::make_unique<::test::Listener>();
  Process run(run_marked(folder.path(), {"--clock", "real", "--markers", "tcp:" + listener->port()}));
  listener->accept();
  listener->read_until("trial_begin");
  listener.reset();
  const Ended ended = run.wait();
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("are lost (the receiver is gone"));
  EXPECT_THAT(ended.out, AllOf(HasSubstr("2 of 2 steps done"), Not(HasSubstr(" 0 lost"))));
  EXPECT_GT(count_in(folder / "s.db", "SELECT count(*) FROM marker WHERE lost LIKE 'the receiver is gone%'"),
            5);
}

TEST(VipStudyMarkersE2e, WhatCannotBeSentIsRefusedBeforeTheSession) {
  const TemporaryFolder folder;
  Ended ended = run_program(run_marked(folder.path(), {"--markers", "tcp:9"}));
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr("virtual clock has no real time to mark"));
  ended = run_program(run_marked(folder.path(), {"--clock", "real", "--markers", "serial:/dev/none"}));
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr("ls /dev/serial/by-id"));
  ended = run_program(run_marked(folder.path(), {"--clock", "real", "--marker-pulse-ms", "5"}));
  EXPECT_NE(ended.exit_code, 0);
  EXPECT_THAT(ended.err, HasSubstr("--marker-pulse-ms requires --markers"));
  EXPECT_FALSE(fs::exists(folder / "s.db"));
  ended = run_program({vip_study, "markers", "--test", ""});
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr("write serial:/dev/ttyUSB0"));
  ended = run_program({vip_study, "markers", "--marker-pulse-ms", "5"});
  EXPECT_THAT(ended.err, HasSubstr("--marker-pulse-ms requires --test"));
}

TEST(VipStudyMarkersE2e, OneReceiverWithTwoNamesIsRefused) {
  const TemporaryFolder folder;
  const ::test::Listener listener;
  const ::test::SerialLine box;
  fs::create_symlink(box.path(), folder.path() / "box");
  const std::string port = listener.port(), link = "serial:" + (folder / "box").string();
  const std::vector<std::pair<std::string, std::string>> pairs{
      {"tcp:" + port, "tcp:127.0.0.1:" + port},
      {"tcp:127.0.0.1:" + port, "tcp:localhost:" + port},
      {"serial:" + box.path(), link + ":9600"},
      {link, "serial:" + folder.path().string() + "/../" + folder.path().filename().string() + "/box"}};
  for (const auto& [one, other] : pairs) {
    const Ended ended =
        run_program(run_marked(folder.path(), {"--clock", "real", "--markers", one, "--markers", other}));
    EXPECT_EQ(ended.exit_code, 1) << one << " " << other;
    EXPECT_THAT(ended.err, HasSubstr("go to the same receiver as those to " + one));
  }
  EXPECT_FALSE(fs::exists(folder / "s.db"));
  EXPECT_FALSE(study::same_marker_receiver("tcp:" + port, "tcp:9"));
  EXPECT_FALSE(study::same_marker_receiver("serial:/dev/none", "serial:/dev/none2"));
  EXPECT_FALSE(study::same_marker_receiver("lsl:a", "lsl:b"));
}

TEST(VipStudyMarkersE2e, TestMarkersTellLatencyOrWhyTheyWereLost) {
  const TemporaryFolder folder;
  ::test::SerialLine box;
  const std::vector<std::string> few{"--count", "3", "--interval-ms", "1", "--marker-pulse-ms", "1"};
  const auto try_out = [&](const std::string& receiver) {
    std::vector<std::string> arguments{vip_study, "markers", "--test", receiver};
    arguments.insert(arguments.end(), few.begin(), few.end());
    return run_program(arguments);
  };
  const Ended good = try_out("serial:" + box.path());
  EXPECT_EQ(good.exit_code, 0) << good.err;
  EXPECT_THAT(good.out, HasSubstr(": 3 written, 0 lost; from event to completed write: median "));
  EXPECT_EQ(box.read(7), std::string("\0\x0a\0\x0a\0\x0a\0", 7));
  const ::test::LslStub stub(folder.path(), 0);
  const Ended lost = try_out("lsl:water");
  EXPECT_EQ(lost.exit_code, 1);
  EXPECT_THAT(lost.err, HasSubstr("3 of 3 were lost: no recorder listens to the stream"));
}

}  // namespace
}  // namespace apps::test
