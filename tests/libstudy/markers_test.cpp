/// Markers: their codes and lines, each kind of receiver, and a receiver that is slow or gone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <future>
#include <sstream>
#include <thread>

#include "libstudy/base/clock.hpp"
#include "libstudy/markers/marker_sender.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/marker_receivers.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace study {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

Marker now(MarkerKind kind, int position = 3) {
  Marker marker;
  marker.kind = kind;
  marker.slot = 70;
  marker.position = position;
  marker.clock_ns = RealClock().now_ns();
  marker.utc_ns = utc_ns_of(marker.clock_ns);
  return marker;
}

std::string error_of(const std::string& receiver) {
  try {
    open_marker_receiver(receiver, {});
  } catch (const base::Error& error) {
    return error.what();
  }
  return "no error";
}

/// Sends the kinds to one receiver; returns what became of each: "" or why it was lost.
std::vector<std::string> send_all(const std::string& receiver, const std::vector<MarkerKind>& kinds,
                                  int pulse_ms = 1) {
  MarkerSenders senders({receiver}, {pulse_ms});
  for (const MarkerKind kind : kinds) senders.send(now(kind));
  senders.finish();
  std::vector<std::string> lost;
  for (const MarkerRecord& record : senders.take()) {
    lost.push_back(record.lost);
    EXPECT_TRUE(!record.lost.empty() || record.written_ns >= record.marker.clock_ns);
  }
  return lost;
}

/// A receiver whose first write waits until the test lets it go.
class Held final : public MarkerReceiver {
 public:
  explicit Held(std::shared_future<void> let_go) : let_go_(std::move(let_go)) {}
  std::string write(const Marker&, std::int64_t) override {
    let_go_.wait();
    return "";
  }

 private:
  std::shared_future<void> let_go_;
};

/// A receiver that takes 0.1 s for each marker.
class Slow final : public MarkerReceiver {
 public:
  std::string write(const Marker&, std::int64_t) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return "";
  }
};

TEST(Markers, CodesAndLinesAreThoseOfTheDocs) {
  Marker marker = now(MarkerKind::SessionBegin, -1);
  EXPECT_EQ(marker_code(marker), 64 + 70 - 64);
  marker = now(MarkerKind::TrialBegin, 130);
  EXPECT_EQ(marker_code(marker), 128 + 2);
  marker = now(MarkerKind::StimulusOnset);
  marker.attempt = 2;
  marker.stimulus = 2;
  marker.clock_ns = 5;
  marker.display_ns = 9;
  marker.utc_ns = 1'767'225'600'123'456'789;
  EXPECT_EQ(marker_header(), "event,code,slot,position,attempt,stimulus,clock_ns,display_ns,utc\n");
  EXPECT_EQ(marker_line(marker), "stimulus_onset,4,70,3,2,2,5,9,2026-01-01T00:00:00.123456Z\n");
  EXPECT_EQ(marker_tags(marker), "stimulus_onset/slot 70/position 3/attempt 2/stimulus 2");
  EXPECT_EQ(marker_line(Marker{MarkerKind::SessionEnd}),
            "session_end,1,0,,,,0,,1970-01-01T00:00:00.000000Z\n");
  const std::string page = base::read_file(base::resource("docs/session.md"), 1 << 20);
  EXPECT_THAT(page, HasSubstr(marker_code_table()));
  EXPECT_THAT(page, HasSubstr(marker_header()));
}

TEST(Markers, SummaryHasMedianQuantileAndLosses) {
  std::vector<MarkerRecord> records;
  for (int i = 0; i <= 20; ++i) records.push_back({{}, "tcp:1", 1'000'000 * i});
  records.push_back({{}, "tcp:1", 0, "gone"});
  records.push_back({{MarkerKind::StimulusOnset}, "serial:2", 250'000});
  EXPECT_EQ(
      marker_summary(records),
      "markers to serial:2: 1 written, 0 lost; from event to completed write: median 0.250 ms, 95 % "
      "0.250 ms, longest 0.250 ms; of 1 stimulus onsets: median 0.250 ms, 95 % 0.250 ms, longest 0.250 ms\n"
      "markers to tcp:1: 21 written, 1 lost; from event to completed write: median 10.000 ms, 95 % "
      "19.000 ms, longest 20.000 ms\n");
  EXPECT_EQ(marker_summary({}), "");
}

TEST(Markers, ASerialPortGetsOneByteEachAndRestsBetween) {
  test::SerialLine line;
  EXPECT_THAT(send_all("serial:" + line.path() + ":9600", {MarkerKind::TrialBegin, MarkerKind::Cut}),
              ElementsAre("", ""));
  EXPECT_EQ(line.read(5), std::string("\0\x83\0\x09\0", 5));
}

TEST(Markers, WithoutAPulseASerialPortGetsNoRest) {
  test::SerialLine line;
  send_all("serial:" + line.path(), {MarkerKind::TrialBegin, MarkerKind::Cut}, 0);
  EXPECT_EQ(line.read(2), "\x83\x09");
}

TEST(Markers, ATriggerBoxThatTakesNothingIsToldAndLateTriggersAreNotSent) {
  test::SerialLine line;
  MarkerSenders senders({"serial:" + line.path()}, {0});
  line.fill();
  for (int i = 0; i < 4; ++i) senders.send(now(MarkerKind::Cut));
  const auto records = senders.take_settled();
  EXPECT_THAT(senders.take_news(),
              ElementsAre(HasSubstr("are lost (the port takes nothing); the session goes on")));
  ASSERT_EQ(records.size(), 4u);
  EXPECT_EQ(records[0].lost, "the port takes nothing");
  EXPECT_EQ(records[3].lost, "too late for a trigger");
}

TEST(Markers, AnUnpluggedPortIsTold) {
  test::SerialLine line;
  MarkerSenders senders({"serial:" + line.path()}, {1});
  line.unplug();
  senders.send(now(MarkerKind::Cut));
  EXPECT_THAT(senders.take_settled().at(0).lost, HasSubstr("the port is gone"));
}

TEST(Markers, LinesGoOverTcpAndAgainAfterTheReceiverWasAway) {
  test::Listener listener;
  MarkerSenders senders({"tcp:" + listener.port()}, {});
  listener.accept();
  senders.send(now(MarkerKind::TrialBegin));
  EXPECT_THAT(listener.read_until("trial_begin"), StartsWith(marker_header() + "trial_begin,131,70,3,,,"));
  listener.hang_up();
  senders.send(now(MarkerKind::Cut));
  senders.take_settled();
  EXPECT_THAT(senders.take_news(), ElementsAre(HasSubstr("it closed the connection")));
  senders.send(now(MarkerKind::PauseBegin));
  listener.accept();
  senders.send(now(MarkerKind::PauseEnd));
  const std::string again = listener.read_until("pause_end");
  EXPECT_THAT(again, StartsWith(marker_header()));
  EXPECT_THAT(again, ::testing::Not(HasSubstr("cut")));
  senders.finish();
  senders.take();
  EXPECT_THAT(senders.take_summary(), HasSubstr("3 written, 1 lost"));
}

TEST(Markers, AReceiverThatStopsReadingGetsWholeLinesOnly) {
  test::Listener listener;
  const auto receiver = open_marker_receiver("tcp:127.0.0.1:" + listener.port(), {});
  listener.accept();
  int written = 0, lost = 0;
  while (lost < 3 && written < 10'000) {
    const std::string reason = receiver->write(now(MarkerKind::Cut), 0);
    if (reason.empty()) {
      ++written;
      continue;
    }
    EXPECT_EQ(reason, "the receiver does not read");
    ++lost;
  }
  EXPECT_EQ(lost, 3) << "a receiver that does not read is noticed soon";
  std::future<std::string> all = std::async([&] { return listener.read_until("session_end"); });
  while (!receiver->write(now(MarkerKind::SessionEnd, -1), 0).empty()) {
  }
  std::istringstream lines(all.get());
  std::string line;
  std::getline(lines, line);
  int came = 0;
  for (; std::getline(lines, line) && line.starts_with("cut,9,70,3,,,"); ++came)
    ASSERT_EQ(std::count(line.begin(), line.end(), ','), 8) << line;
  EXPECT_TRUE(line.starts_with("session_end,1,70,,,,")) << line;
  // The rest of a line that was counted as lost goes out later.
  EXPECT_THAT(came, ::testing::AllOf(::testing::Ge(written), ::testing::Le(written + lost)));
}

TEST(Markers, TheSessionNeverWaitsAndLostMarkersAreCounted) {
  std::promise<void> let_go;
  MarkerSender sender("held", std::make_unique<Held>(let_go.get_future().share()));
  const int count = static_cast<int>(MarkerSender::capacity) + 100;
  for (int i = 0; i < count; ++i) sender.send(now(MarkerKind::Test, i));  // would hang if it waited
  let_go.set_value();
  sender.finish();
  int lost = 0, place = 0;
  for (const MarkerRecord& record : sender.take()) {
    lost += record.lost == "the queue was full";
    if (!record.lost.empty()) continue;
    EXPECT_EQ(record.marker.position, place);
    ++place;
  }
  EXPECT_EQ(place, static_cast<int>(MarkerSender::capacity));
  EXPECT_EQ(lost, 100);
}

TEST(Markers, AtItsEndASessionWaitsASecondAndCountsTheRestAsLost) {
  MarkerSender sender("slow", std::make_unique<Slow>());
  for (int i = 0; i < 30; ++i) sender.send(now(MarkerKind::Test, i));
  sender.settle();
  const auto records = sender.take();
  ASSERT_EQ(records.size(), 30u);
  EXPECT_EQ(records.front().lost, "");
  EXPECT_EQ(records.back().lost, "the session had ended");
  sender.send(now(MarkerKind::Test));
  sender.settle();
  EXPECT_EQ(sender.take().at(0).lost, "") << "the next session's markers are sent";
}

TEST(Markers, LslGetsTheTimeOfTheEventThroughTheStub) {
  const test::TemporaryFolder folder;
  const test::LslStub stub(folder.path());
  const Marker marker = now(MarkerKind::StimulusOnset);
  {
    const auto receiver = open_marker_receiver("lsl:water", {});
    EXPECT_EQ(receiver->write(marker, 0), "");
    test::LslStub::listen(0);
    EXPECT_EQ(receiver->write(marker, 0), "no recorder listens to the stream");
  }
  std::istringstream log(test::bytes_of(stub.log()));
  std::vector<std::string> lines;
  for (std::string line; std::getline(log, line);) lines.push_back(line);
  EXPECT_THAT(lines, ElementsAre("streaminfo water, Markers, 1 channel, rate 0, format 3, vip-study water",
                                 "outlet right, chunk 0, buffered 360", "destroy streaminfo",
                                 StartsWith("push stimulus_onset/slot 70/position 3, "), "destroy outlet"));
  double time_s = 0;
  ASSERT_EQ(std::sscanf(lines[3].c_str(), "push stimulus_onset/slot 70/position 3, %lf, 1, right", &time_s),
            1);
  // The stub's clock is the session's; between the two readings of the clocks a thread may be stopped.
  EXPECT_NEAR(time_s, 1e-9 * static_cast<double>(marker.clock_ns), 0.5);
}

TEST(Markers, EachProblemBeforeASessionHasARemedy) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(error_of("lpt:1"), HasSubstr("is no kind of receiver"));
  EXPECT_THAT(error_of("serial:"), HasSubstr("names no receiver"));
  EXPECT_THAT(error_of("serial:/dev/none"), HasSubstr("/dev/none: No such file"));
  EXPECT_THAT(error_of("serial:" + (folder / "").string()), HasSubstr("neither a serial port nor a FIFO"));
  EXPECT_THAT(error_of("serial:/dev/null:9600"), HasSubstr("leave out :9600"));
  const test::SerialLine line;
  EXPECT_THAT(error_of("serial:" + line.path() + ":9601"), HasSubstr("9601 is no baud rate"));
  const std::string fifo = folder / "fifo";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_THAT(error_of("serial:" + fifo), HasSubstr("start the program that reads it first"));
  for (const char* text : {"tcp:", "tcp:99999", "tcp:host:", "tcp::80", "tcp:0"})
    EXPECT_THAT(error_of(text), HasSubstr("mend: write ")) << text;
  const std::string deserted = "tcp:" + test::Listener().port();
  EXPECT_THAT(error_of(deserted), HasSubstr("nothing listens there: Connection refused"));
  ::setenv("VIP_LSL_LIBRARY", "/none/liblsl.so", 1);
  EXPECT_THAT(error_of("lsl:water"), HasSubstr("correct its path, or unset VIP_LSL_LIBRARY"));
  ::setenv("VIP_LSL_LIBRARY", "libm.so.6", 1);
  EXPECT_THAT(error_of("lsl:water"), HasSubstr("has no lsl_create_streaminfo"));
  ::unsetenv("VIP_LSL_LIBRARY");
  EXPECT_THAT(error_of("lsl:water"), HasSubstr("install liblsl"));
}

/// The markers of a session as tags.
std::vector<std::string> texts_of(const std::vector<Marker>& markers) {
  std::vector<std::string> texts;
  for (const Marker& marker : markers) texts.push_back(marker_tags(marker));
  return texts;
}

TEST(Markers, ASessionMarksItsTrialsPagesPausesAndCuts) {
  test::OneSession session(test::paced_pairs());
  std::vector<Marker> markers;
  SessionHooks hooks = test::wish_at_frame_5(CutCause::Minimised, 1);
  hooks.mark = [&](const Marker& marker) { markers.push_back(marker); };
  session.run(hooks);
  const auto texts = texts_of(markers);
  EXPECT_EQ(texts.front(), "session_begin/slot 0");
  EXPECT_EQ(texts.back(), "session_end/slot 0");
  const auto first =
      std::find_if(texts.begin(), texts.end(), [](const auto& t) { return t.starts_with("trial"); });
  ASSERT_GE(texts.end() - first, 14);
  const std::string place = first->substr(first->find('/'), first->rfind("/attempt") - first->find('/'));
  const std::string cut = place + "/attempt 1", again = place + "/attempt 2";
  EXPECT_THAT(std::vector(first, first + 13),
              ElementsAre("trial_begin" + cut, "stimulus_onset" + cut + "/stimulus 1", "cut" + cut,
                          "trial_begin" + again, "stimulus_onset" + again + "/stimulus 1",
                          "stimulus_onset" + again + "/stimulus 2", "question_shown" + again,
                          "answer_given" + again, "pause_begin" + again, "pause_end" + again,
                          "question_shown" + again, "answer_given" + again, "trial_end" + again));
  EXPECT_TRUE(std::is_sorted(markers.begin(), markers.end(),
                             [](const Marker& a, const Marker& b) { return a.clock_ns < b.clock_ns; }));
  // An onset is the first frame in the record.
  std::vector<std::int64_t> onsets, frames;
  for (const Marker& marker : markers) {
    if (marker.kind == MarkerKind::StimulusOnset) onsets.push_back(marker.clock_ns);
  }
  sqlite::Connection database(session.folder / "study.db", sqlite::Open::Read);
  sqlite::Statement row(database,
                        "SELECT start_ns + scheduled_ns + submitted_ns FROM frame JOIN presentation USING "
                        "(presentation_id) WHERE frame_index = 0 ORDER BY presentation_id");
  while (row.step()) frames.push_back(row.integer(0));
  EXPECT_EQ(onsets, frames);
}

TEST(Markers, AStoppedSessionMarksTheCutAndItsEnd) {
  test::OneSession session(test::paced_pairs());
  std::vector<Marker> markers;
  SessionHooks hooks = test::wish_at_frame_5(Request::Stop, 1);
  hooks.mark = [&](const Marker& marker) { markers.push_back(marker); };
  EXPECT_THROW(session.run(hooks), Stopped);
  ASSERT_GE(markers.size(), 2u);
  EXPECT_EQ(markers[markers.size() - 2].kind, MarkerKind::Cut);
  EXPECT_EQ(markers.back().kind, MarkerKind::SessionEnd);
}

/// The markers of a database: participant, event and latency.
std::string stored(const std::filesystem::path& path) {
  sqlite::Connection database(path, sqlite::Open::Read);
  sqlite::Statement row(
      database,
      "SELECT participant || ' ' || event || ' ' || coalesce(latency_ns, lost) FROM marker JOIN "
      "session USING (session_id) ORDER BY 1");
  std::string all;
  while (row.step()) all += row.text(0) + "; ";
  return all;
}

TEST(Markers, AreKeptMergedSalvagedExportedAndWithdrawn) {
  const test::TemporaryFolder folder;
  const auto path = folder / "study.db";
  {
    Store store(path, sqlite::Open::Create);
    store.add_run(test::run_plan(test::pairs(), {"P01", "P02"}));
    Marker onset = now(MarkerKind::StimulusOnset);
    onset.stimulus = 1;
    const std::vector<MarkerRecord> records{{onset, "tcp:7", onset.clock_ns + 1500},
                                            {now(MarkerKind::Cut), "tcp:7", 0, "the port is gone"}};
    const auto runs = store.open_runs();
    for (const OpenSession& session : runs.at(0).sessions) store.add_markers(session.id, records);
    EXPECT_THAT(store.marker_receivers(1), ElementsAre("tcp:7"));
  }
  const std::string second = "P02 cut the port is gone; P02 stimulus_onset 1500; ";
  const std::string both = "P01 cut the port is gone; P01 stimulus_onset 1500; " + second;
  EXPECT_EQ(stored(path), both);
  merge({path}, folder / "merged.db");
  EXPECT_EQ(stored(folder / "merged.db"), both);
  salvage(path, folder / "salvaged.db");
  EXPECT_EQ(stored(folder / "salvaged.db"), both);
  export_csv(path, folder / "csv");
  const std::string csv = test::bytes_of(folder / "csv/markers.csv");
  EXPECT_THAT(csv, HasSubstr(",tcp:7,stimulus_onset,3,70,3,,1,"));
  EXPECT_THAT(test::bytes_of(folder / "csv/dictionary.csv"), HasSubstr("markers.csv,latency_ns,"));
  withdraw(path, "P01");
  EXPECT_EQ(stored(path), second);
}

}  // namespace
}  // namespace study
