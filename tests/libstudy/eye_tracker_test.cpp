/// Eye trackers outside OpenXR: the lines of their senders, their clock, and senders that are broken or gone.
#include "libstudy/trackers/eye_tracker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <future>
#include <limits>

#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/gaze_sender.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace study {
namespace {

using test::GazeSender;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::Le;
using ::testing::SizeIs;

constexpr std::int64_t second_ns = 1'000'000'000;

std::string problem_of(const std::string& line) {
  const TrackerLine read = parse_tracker_line(line);
  const auto* unreadable = std::get_if<UnreadableLine>(&read);
  return unreadable ? unreadable->problem : "";
}

TEST(TrackerLine, SamplesPongsAndNamesAreRead) {
  const auto sample = std::get<TrackerSample>(parse_tracker_line("g 12.000000001 1 3 0 -4\r"));
  EXPECT_EQ(sample.device_ns, 12'000'000'001);
  EXPECT_TRUE(sample.valid);
  EXPECT_DOUBLE_EQ(sample.direction[0], 0.6);
  EXPECT_DOUBLE_EQ(sample.direction[2], -0.8);
  EXPECT_FALSE(std::get<TrackerSample>(parse_tracker_line("g 1e3 0")).valid);
  EXPECT_FALSE(std::get<TrackerSample>(parse_tracker_line("g 1 0 nan nan nan")).valid);
  const auto tiny = std::get<TrackerSample>(parse_tracker_line("g 1 1 0 1e-200 0"));
  EXPECT_DOUBLE_EQ(tiny.direction[1], 1);
  const auto pong = std::get<TrackerPong>(parse_tracker_line("p 7 0.5"));
  EXPECT_EQ(pong.number, 7);
  EXPECT_EQ(pong.device_ns, second_ns / 2);
  EXPECT_EQ(std::get<TrackerHello>(parse_tracker_line("vip-gaze 1 Varjo XR-3")).device, "Varjo XR-3");
}

TEST(TrackerLine, EverythingElseIsUnreadable) {
  for (const char* line : {"",
                           "g",
                           "g 1",
                           "g nan 1 0 0 -1",
                           "g inf 0",
                           "g 5e9 0",
                           "g 1 2 0 0 -1",
                           "g 1 1 0 0",
                           "g 1 1 0 0 -1 9",
                           "g 1 1 0 nan -1",
                           "g 1 1 0 inf -1",
                           "g 1 1 0 0 0",
                           "g 1 1 a b c",
                           "g 1 1 1.7e308 1.7e308 1.7e308",
                           "g 1,0 0",
                           "p 1",
                           "p x 1",
                           "p 1 nan",
                           "GET / HTTP/1.1",
                           "vip-gaze 2 X",
                           "vip-gaze 1 ",
                           "vip-gaze 1  ",
                           "vip-gaze 1 a\x01",
                           "vip-gaze 1 \xff",
                           "vip-gazes 1 X"})
    EXPECT_NE(problem_of(line), "") << line;
  EXPECT_NE(problem_of("g 1 1 0 0 -1" + std::string(190, ' ')), "");
  EXPECT_EQ(problem_of("g 1 1 0 0 -1" + std::string(180, ' ')), "");
}

TEST(EyeTracker, ATurnIsToTheLeftThenUpThenLeaning) {
  const auto turned = [](const std::array<double, 3>& deg, const std::array<double, 3>& v) {
    const auto r = rotation_of(deg);
    std::array<double, 3> out{};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) out[i] += r[3 * i + k] * v[k];
      out[i] = std::round(1e6 * out[i]) / 1e6;
    }
    return out;
  };
  EXPECT_THAT(turned({90, 0, 0}, {0, 0, -1}), ElementsAre(-1, 0, 0));
  EXPECT_THAT(turned({0, 90, 0}, {0, 0, -1}), ElementsAre(0, 1, 0));
  EXPECT_THAT(turned({0, 0, 90}, {1, 0, 0}), ElementsAre(0, 1, 0));
  EXPECT_THAT(turned({0, 0, 90}, {0, 0, -1}), ElementsAre(0, 0, -1));
  EXPECT_THAT(turned({90, 90, 0}, {1, 0, 0}), ElementsAre(0, 0, -1));
  EXPECT_THROW(rotation_of({0, std::numeric_limits<double>::quiet_NaN(), 0}), base::Error);
}

/// Takes samples until `enough` of them have come or 10 s are over.
std::vector<TrackedGaze> take_some(EyeTracker& tracker, std::size_t enough) {
  std::vector<TrackedGaze> all;
  for (int i = 0; i < 2000 && all.size() < enough; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const auto some = tracker.take();
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

template <class F>
bool soon(F&& what) {
  for (int i = 0; i < 2000; ++i) {
    if (what()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

TEST(EyeTracker, SamplesGetTheComputersTimeAndAreKeptFromStartToStopAlone) {
  GazeSender sender({.pong_delay_ms = 3, .direction = "0.6 0 -0.8"});
  EyeTracker tracker(sender.name(), {0, 0, 180});
  EXPECT_EQ(tracker.device(), "A tracker");
  ASSERT_TRUE(soon([&] { return sender.sent > 20; }));
  EXPECT_THAT(tracker.take(), SizeIs(0)) << "before consent";
  tracker.start();
  const auto samples = take_some(tracker, 20);
  const TrackerClock clock = tracker.clock();
  // The offset is right within half the round trip.
  EXPECT_LE(std::abs(clock.offset_ns + 1000 * second_ns), clock.round_trip_ns / 2 + 1);
  std::int64_t before_ns = 0;
  for (const TrackedGaze& sample : samples) {
    EXPECT_EQ(sample.sampled_ns, sample.device_ns + clock.offset_ns);
    EXPECT_GT(sample.sampled_ns, before_ns);
    EXPECT_NEAR(sample.direction[0], -0.6, 1e-12);
    before_ns = sample.sampled_ns;
  }
  EXPECT_THAT(tracker.take_clocks(), SizeIs(1));
  tracker.stop();
  EXPECT_TRUE(soon([&] { return tracker.clock().clock_ns > clock.clock_ns; })) << "measured between trials";
  EXPECT_THAT(tracker.take(), SizeIs(0));
  EXPECT_EQ(tracker.trouble(), "");
  EXPECT_THAT(tracker.take_news(), SizeIs(0));
}

TEST(EyeTracker, ASenderThatDiesIsMissedAndFoundAgain) {
  GazeSender sender;
  EyeTracker tracker(sender.name());
  tracker.start();
  sender.gone = true;
  ASSERT_TRUE(soon([&] { return !tracker.trouble().empty(); }));
  EXPECT_TRUE(
      soon([&] { return tracker.trouble().find("is gone: it closed the conn") != std::string::npos; }));
  tracker.take();
  sender.gone = false;
  EXPECT_THAT(take_some(tracker, 10), SizeIs(Ge(10u)));
  EXPECT_EQ(tracker.trouble(), "");
  EXPECT_THAT(tracker.take_news(), ElementsAre(HasSubstr("is gone: it closed the"), HasSubstr("is back")));
  EXPECT_THAT(tracker.take_clocks(), SizeIs(2));
  sender.silent = true;
  EXPECT_TRUE(soon([&] { return tracker.trouble().find("sends no samples") != std::string::npos; }));
}

TEST(EyeTracker, BrokenLinesAndTimesAreCountedAndNotUsed) {
  GazeSender sender;
  EyeTracker tracker(sender.name());
  tracker.start();
  take_some(tracker, 5);
  sender.silent = true;
  const std::string ahead = " 1 0 0 -1\n", now = sender.time();
  // 4 unreadable lines, one of them huge; 1 sample of the past, 2 far ones; the rest of a line comes later.
  sender.say("g nan" + ahead + std::string(100'000, 'x') + "\n\x80\xff\n" + "p 99999 1\n" +
             "vip-gaze 1 Again\n");
  sender.say("g " + sender.time(-0.5) + ahead + "g " + sender.time(3600) + ahead + "g 4" + ahead);
  EXPECT_TRUE(soon([&] { return tracker.counts().far == 2; }));
  EXPECT_TRUE(soon([&] { return tracker.trouble().find("gives times far") != std::string::npos; }));
  const TrackerCounts counts = tracker.counts();
  EXPECT_EQ(counts.unreadable, 4);
  EXPECT_EQ(counts.backwards, 1);
  tracker.take();
  const std::string whole = "g " + sender.time() + ahead;
  sender.say(whole.substr(0, 9));
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  sender.say(whole.substr(9));
  EXPECT_THAT(take_some(tracker, 1), SizeIs(1));
  tracker.stop();
  EXPECT_THAT(tracker.take_news(),
              AllOf(SizeIs(3), Contains(HasSubstr("4 lines or values could not be read"))));
}

TEST(EyeTracker, AFloodFillsNoMemory) {
  GazeSender sender;
  EyeTracker tracker(sender.name());
  tracker.start();
  take_some(tracker, 5);
  sender.silent = true;
  const double now_s = std::stod(sender.time());
  std::string flood;
  for (int i = 0; i < 20'000; ++i) flood += fmt::format("g {:.6f} 1 0 0 -1\n", now_s + 1e-6 * i);
  sender.say(flood);
  EXPECT_TRUE(soon([&] { return tracker.counts().overflow > 0; }));
  EXPECT_THAT(tracker.take(), SizeIs(AllOf(Ge(1u), Le(8192u))));
}

std::string opening_error(const std::string& gaze) {
  try {
    EyeTracker tracker(gaze);
  } catch (const base::Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(EyeTracker, EachProblemBeforeASessionHasARemedy) {
  // These wait for 3 s each, so they wait together.
  const test::Listener mute;
  auto no_line = std::async([&] { return opening_error("tcp:" + mute.port()); });
  auto no_pong = std::async([] { return opening_error(GazeSender({.answers_pings = false}).name()); });
  const std::string deserted = "tcp:" + test::Listener().port();
  EXPECT_THAT(opening_error(deserted), HasSubstr("no sender of gaze listens there: Connection refused"));
  EXPECT_THAT(opening_error("tcp:99999"), HasSubstr("mend: write tcp:PORT"));
  EXPECT_THAT(opening_error("tcp:"), HasSubstr("names no eye tracker"));
  for (const std::string hello : {"HTTP/1.1 200 OK\n", "vip-gaze 2 X\n", "vip-gaze 1 \n"})
    EXPECT_THAT(opening_error(GazeSender({.hello = hello}).name()),
                HasSubstr("first line is not 'vip-gaze 1"));
  EXPECT_THAT(opening_error(GazeSender({.hello = std::string(5000, 'x')}).name()),
              HasSubstr("first line is not"));
  EXPECT_THAT(no_line.get(), HasSubstr("sent no first line"));
  EXPECT_THAT(no_pong.get(), HasSubstr("let the sender answer each line 'p NUMBER'"));
  EXPECT_FALSE(crosses_network("tcp:7007"));
  EXPECT_FALSE(crosses_network("tcp:[::1]:7007"));
  EXPECT_TRUE(crosses_network("tcp:192.168.1.20:7007"));
  EXPECT_TRUE(crosses_network("lsl:eyes"));
}

/// A setting of the stub of liblsl, for the lifetime of this object.
class Stubbed {
 public:
  Stubbed(const char* name, const char* value) : name_(name) { ::setenv(name, value, 1); }
  ~Stubbed() { ::unsetenv(name_); }
  Stubbed(const Stubbed&) = delete;
  Stubbed& operator=(const Stubbed&) = delete;

 private:
  const char* name_;
};

TEST(EyeTracker, LslGivesSamplesAndTheirOffsetThroughTheStub) {
  const test::TemporaryFolder folder;
  const test::LslStub stub(folder.path());
  EyeTracker tracker("lsl:eyes");
  EXPECT_EQ(tracker.device(), "eyes on lab-pc");
  tracker.start();
  const auto samples = take_some(tracker, 25);
  ASSERT_THAT(samples, SizeIs(Ge(25u)));
  const TrackerClock clock = tracker.clock();
  EXPECT_GE(clock.round_trip_ns, 200'000);
  EXPECT_NEAR(static_cast<double>(clock.offset_ns), -100e9, static_cast<double>(clock.round_trip_ns));
  int valid = 0;
  for (const TrackedGaze& sample : samples) {
    valid += sample.valid;
    EXPECT_NEAR(sample.direction[0], sample.valid ? 0.6 : 0, 1e-12);
  }
  EXPECT_NEAR(valid, 0.9 * static_cast<double>(samples.size()), 1.5);
  const Stubbed lost("LSL_STUB_LOST", "1");
  EXPECT_TRUE(soon([&] { return tracker.trouble().find("its stream has ended") != std::string::npos; }));
}

TEST(EyeTracker, AnLslStreamThatIsNoGazeIsRefused) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(opening_error("lsl:eyes"), HasSubstr("install liblsl"));
  const test::LslStub stub(folder.path());
  for (const auto& [name, value, says] : {std::array{"LSL_STUB_STREAMS", "0", "no stream of this name"},
                                          {"LSL_STUB_STREAMS", "2", "two streams have this name"},
                                          {"LSL_STUB_CHANNELS", "8", "8 channels, and gaze has 3 or 4"},
                                          {"LSL_STUB_FORMAT", "3", "the stream holds text"}}) {
    const Stubbed setting(name, value);
    EXPECT_THAT(opening_error("lsl:eyes"), HasSubstr(says));
  }
}

std::string stored_clocks(const std::filesystem::path& path) {
  sqlite::Connection database(path, sqlite::Open::Read);
  sqlite::Statement row(
      database,
      "SELECT participant || ' ' || source || ' ' || device || ' ' || pitch_deg || ' ' || "
      "offset_ns || ' ' || round_trip_ns FROM tracker_clock JOIN session USING (session_id) "
      "ORDER BY 1");
  std::string all;
  while (row.step()) all += row.text(0) + "; ";
  return all;
}

TEST(EyeTracker, ItsClocksAreKeptMergedSalvagedExportedAndWithdrawn) {
  const test::TemporaryFolder folder;
  const auto path = folder / "study.db";
  {
    Store store(path, sqlite::Open::Create);
    store.add_run(test::run_plan(test::pairs(), {"P01", "P02"}));
    const TrackerClock clock{"tcp:7", "A tracker", {0, -2.5, 0}, RealClock().now_ns(), -1000, 30};
    const auto runs = store.open_runs();
    for (const OpenSession& session : runs.at(0).sessions) store.add_tracker_clocks(session.id, {&clock, 1});
  }
  const std::string second = "P02 tcp:7 A tracker -2.5 -1000 30; ", both = "P01" + second.substr(3) + second;
  EXPECT_EQ(stored_clocks(path), both);
  merge({path}, folder / "merged.db");
  EXPECT_EQ(stored_clocks(folder / "merged.db"), both);
  salvage(path, folder / "salvaged.db");
  EXPECT_EQ(stored_clocks(folder / "salvaged.db"), both);
  export_csv(path, folder / "csv");
  EXPECT_THAT(test::bytes_of(folder / "csv/tracker_clocks.csv"), HasSubstr(",tcp:7,A tracker,0,-2.5,0,"));
  EXPECT_THAT(test::bytes_of(folder / "csv/dictionary.csv"), HasSubstr("tracker_clocks.csv,offset_ns,"));
  withdraw(path, "P01");
  EXPECT_EQ(stored_clocks(path), second);
}

}  // namespace
}  // namespace study
