/// Gaze is recorded only from people who allow it, from the moment that they do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "libstudy/session/frame_journal.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/permission_fixture.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace study {
namespace {

using sqlite::Connection;
using sqlite::Open;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

/// Delivers two samples at each read: a valid one and one of a blink.
class TwoEach final : public GazeSource {
 public:
  explicit TwoEach(const Clock& clock) : clock_(clock) {}
  GazeOrigin origin() const override { return GazeOrigin::Tracker; }
  void start() override {
    ++starts;
    started_ = true;
  }
  std::vector<GazeSample> take() override {
    EXPECT_TRUE(started_);
    const std::int64_t now_ns = clock_.now_ns();
    return {{now_ns, 7, true, GazePoint{0.25, 0.75}}, {now_ns, {}, false, {}}};
  }
  void stop() override { started_ = false; }

  int starts = 0;

 private:
  const Clock& clock_;
  bool started_ = false;
};

/// A session of asking_protocol(). `gaze_kept`: answer to the question whether gaze may be recorded; 1 yes, 0
/// no.
struct Asked : test::OneSession {
  explicit Asked(int gaze_kept, const Protocol& asking = test::asking_protocol()) : OneSession(asking) {
    person.says[gaze_question] = test::score(gaze_kept);
    person.says["rating"] = test::score(4);
  }
  void run(const SessionHooks& hooks = {}) {
    SessionParts parts = desk.parts(person, store);
    parts.gaze = &source;
    const auto runs = open();
    run_session(protocol, runs.at(0).sessions.at(0), parts, hooks);
  }
  TwoEach source{desk.clock};
};

TEST(Gaze, IsRecordedWithEachFrameOfWhoAllowsIt) {
  Asked asked(1);
  asked.run();
  // Two presentations of 10 and 25 frames; the source is read after every frame and at the end.
  EXPECT_EQ(asked.count("gaze"), 2 * (10 + 1 + 25 + 1));
  EXPECT_EQ(
      asked.count("gaze WHERE source = 'tracker' AND valid = 1 AND x = 0.25 AND y = 0.75 AND device_ns = 7"),
      10 + 1 + 25 + 1);
  EXPECT_EQ(asked.count("gaze WHERE valid = 0 AND x IS NULL AND y IS NULL AND device_ns IS NULL"),
            10 + 1 + 25 + 1);
  EXPECT_EQ(asked.count("(SELECT 1 FROM gaze GROUP BY presentation_id HAVING min(sample_index) = 0 "
                        "AND max(sample_index) = count(*) - 1)"),
            2);
  EXPECT_EQ(asked.count("gaze JOIN presentation USING (presentation_id) "
                        "WHERE sampled_ns < 0 OR sampled_ns > end_ns - start_ns"),
            0);
}

TEST(Gaze, OfWhoRefusesIsNotEvenAskedFor) {
  Asked asked(0);
  asked.run();
  EXPECT_EQ(asked.count("presentation WHERE state = 'played'"), 2);
  EXPECT_EQ(asked.count("gaze"), 0);
  EXPECT_EQ(asked.source.starts, 0);
}

TEST(Gaze, IsNotRecordedWhereTheProtocolDoesNotAsk) {
  Asked asked(1, test::asking_protocol(false));
  asked.run();
  EXPECT_EQ(asked.count("presentation WHERE state = 'played'"), 2);
  EXPECT_EQ(asked.count("gaze"), 0);
}

TEST(Gaze, BeginsAfterTheConsentPageAndFollowsChanges) {
  Asked asked(1);
  std::vector<std::int64_t> rows_before;
  SessionHooks hooks;
  hooks.begins = [&](const OpenUnit& unit) {
    rows_before.push_back(asked.count("gaze"));
    if (unit.plan.position == 2) {
      Connection(asked.folder / "study.db", Open::Write)
          .execute(
              "INSERT INTO permission_change (session_id, what, granted, utc) "
              "SELECT session_id, 'gaze', 0, 'now' FROM session");
    }
  };
  asked.run(hooks);
  ASSERT_EQ(rows_before.size(), 3u);
  EXPECT_EQ(rows_before[0], 0);
  EXPECT_EQ(rows_before[1], 0);
  EXPECT_GT(rows_before[2], 0);
  EXPECT_EQ(asked.count("gaze"), rows_before[2]);
}

TEST(Gaze, OfACutShowingStays) {
  Asked asked(1);
  asked.run(test::wish_at_frame_5(CutCause::Experimenter, 1));
  EXPECT_EQ(asked.count("presentation WHERE state = 'interrupted'"), 1);
  EXPECT_EQ(asked.count("gaze JOIN presentation USING (presentation_id) WHERE state = 'interrupted'"), 2 * 6);
}

TEST(Gaze, IsRefusedByTheStoreWithoutPermission) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  test::add_people(store, test::asking_protocol(), {{"P01", 0, 1}, {"P02", 1, 0}, {"P03", {}, {}}});
  const GazeSample sample{5, {}, true, GazePoint{0.5, 0.5}};
  for (const std::int64_t presentation : {1, 3}) {
    EXPECT_THAT(
        [&] {
          store.add_gaze(presentation, 0, GazeOrigin::Mouse, {&sample, 1});
        },
        ThrowsMessage<base::Error>(HasSubstr("who refused it")));
  }
  store.add_gaze(2, 0, GazeOrigin::Mouse, {&sample, 1});
  EXPECT_THAT(test::column(folder / "study.db",
                           "SELECT participant || ' ' || source FROM gaze JOIN presentation USING "
                           "(presentation_id) JOIN trial USING (trial_id) JOIN session "
                           "USING (session_id)"),
              ElementsAre("P02 mouse"));
}

TEST(Gaze, IsCommittedInTheBackgroundWithTheFrames) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  test::add_people(store, test::asking_protocol(), {{"P01", 1, 1}});
  FrameJournal journal(store, {1, 1, 0}, GazeOrigin::Mouse, true);
  const auto gaze_rows = [&] { return test::column(folder / "study.db", "SELECT sampled_ns FROM gaze"); };
  FrameRecord frame = test::frames(0, 51).back();
  journal.add(frame, {{{11, {}, true, GazePoint{0, 0}}, {12, {}, false, {}}}, {}});
  while (gaze_rows().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_THAT(gaze_rows(), ElementsAre("11", "12"));
  EXPECT_THAT(journal.finish({{{13, {}, false, {}}}, {}}), IsEmpty());
  EXPECT_THAT(gaze_rows(), ElementsAre("11", "12", "13"));
}

}  // namespace
}  // namespace study
