/// Frame times read from the record of each frame.

#include "libstudy/store/read/frame_times.hpp"

#include <gtest/gtest.h>

#include <string>

#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace {

using study::FrameTimes;
using study::test::TemporaryFolder;

/// A pilot of one participant whose first six trials were shown: 0 and 1 whole, 2 with a lost frame, 3
/// without a frame, 4 with a frame whose time is not known, 5 with frames in the wrong order.
struct RecordedPilot {
  TemporaryFolder folder;
  std::filesystem::path path = folder / "study.db";
  std::string sha256, uid;
  std::vector<int> positions;  ///< of the shown trials

  RecordedPilot() {
    fill();
    const auto read = study::read_tasks(path);
    const study::TaskSession& first = read.protocols.at(0).sessions.at(0);
    for (const auto& one : first.trials)
      if (one.first.played) positions.push_back(one.position);
    uid = first.uid;
    change("UPDATE frame SET submitted_ns = NULL WHERE frame_index = 7 AND presentation_id = 5");
    change("UPDATE frame SET submitted_ns = -30000000 WHERE frame_index = 7 AND presentation_id = 6");
  }
  void fill() {
    study::Store store(path, study::sqlite::Open::Create);
    const auto protocol = study::test::pilot();
    store.add_run(study::test::run_plan(protocol, {"P1"}));
    sha256 = protocol.sha256;
    const std::vector<std::int64_t> frames{40, 40, 39, 0, 40, 40};
    const auto runs = store.open_runs();
    const auto& session = runs.at(0).sessions.at(0);
    std::size_t trial = 0;
    for (const auto& unit : session.units) {
      if (!unit.trial) {
        store.finish_unit(session.id, unit.id, 0);
      } else if (trial < frames.size()) {
        const int attempt = study::test::show(store, session, unit, frames[trial++]);
        const study::KeptAnswer kept{"satisfaction", {study::test::score(4), 1}};
        store.answer(session.id, unit, attempt, {&kept, 1}, true, 900);
      }
    }
  }
  void change(const std::string& sql) {
    study::sqlite::Connection(path, study::sqlite::Open::Write).execute(sql);
  }
  FrameTimes of(std::size_t trial) const {
    return study::read_frame_times(path, sha256).at({uid, positions.at(trial)});
  }
};

TEST(FrameTimes, AreTheIntervalsBetweenTheOnsetsOfTheRecord) {
  const RecordedPilot pilot;
  ASSERT_EQ(pilot.positions.size(), 6u);
  const auto times = pilot.of(0);
  EXPECT_EQ(times.why_not, "");
  ASSERT_EQ(times.intervals_s.size(), 40u);
  // Frame i is submitted 1000 + i ns after its due time, every 20 ms; the last one stays on until 40 * 20 ms.
  for (std::size_t i = 0; i < 39; ++i) EXPECT_NEAR(times.intervals_s[i], 0.020000001, 1e-13);
  EXPECT_NEAR(times.intervals_s[39], 0.02 - 1.039e-6, 1e-13);
  EXPECT_EQ(study::read_frame_times(pilot.path, pilot.sha256).size(), 6u);
  EXPECT_TRUE(study::read_frame_times(pilot.path, std::string(64, '0')).empty());
}

TEST(FrameTimes, ThatAreNotWholeHaveAReason) {
  const RecordedPilot pilot;
  EXPECT_EQ(pilot.of(2).why_not, "39 of 40 frames are recorded");
  EXPECT_EQ(pilot.of(3).why_not, "no frame is recorded");
  EXPECT_EQ(pilot.of(4).why_not, "the time of a frame is not recorded");
  EXPECT_EQ(pilot.of(5).why_not, "the onsets do not ascend");
  for (const std::size_t trial : {2u, 3u, 4u, 5u}) EXPECT_TRUE(pilot.of(trial).intervals_s.empty());
}

TEST(FrameTimes, OfImportsMayHaveReportedOnsetsAloneAndNoEnd) {
  RecordedPilot pilot;
  pilot.change(
      "UPDATE frame SET actual_display_ns = submitted_ns, submitted_ns = NULL WHERE presentation_id = 1");
  pilot.change(
      "UPDATE presentation SET grade = 'B', start_ns = NULL, end_ns = NULL WHERE presentation_id = 1");
  const auto times = pilot.of(0);
  EXPECT_EQ(times.why_not, "");
  ASSERT_EQ(times.intervals_s.size(), 39u);
  for (const double interval_s : times.intervals_s) EXPECT_NEAR(interval_s, 0.020000001, 1e-13);
}

}  // namespace
