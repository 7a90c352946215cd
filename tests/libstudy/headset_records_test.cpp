/// Headset data are stored: slots always, head and gaze only of people who allow them, through upgrades,
/// merges, salvage and refusals.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/permissions.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "stats/base/new_file.hpp"
#include "tests/libstudy/headset_fixture.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

/// An eye tracker that delivers one sample at each read. `loses` returns true for the times at which it does
/// not see the eyes. It then delivers an invalid sample, or none if `silent` is true.
class Eyes final : public GazeSource {
 public:
  explicit Eyes(const Clock& clock) : clock_(clock) {}
  GazeOrigin origin() const override { return GazeOrigin::Tracker; }
  void start() override {}
  std::vector<GazeSample> take() override {
    GazeSample sample = test::ray_sample(clock_.now_ns());
    if (!loses || !loses(sample.sampled_ns)) return {sample};
    if (silent) return {};
    return {{sample.sampled_ns, {}, false, {}, false, {}}};
  }
  void stop() override {}

  std::function<bool(std::int64_t)> loses;
  bool silent = false;

 private:
  const Clock& clock_;
};

/// A session in a headset. `gaze_kept`: answer to the question whether gaze may be recorded; 1 yes, 0 no.
struct Worn : test::OneSession {
  explicit Worn(int gaze_kept) : OneSession(test::asking_protocol()) {
    person.says[gaze_question] = test::score(gaze_kept);
    person.says["rating"] = test::score(4);
  }
  void run(const SessionHooks& hooks = {}) {
    SessionParts parts = desk.parts(person, store);
    parts.gaze = &eyes;
    parts.slots = &slots;
    auto runs = open();
    runs.at(0).sessions.at(0).plan.gaze_source = "tracked";
    run_session(protocol, runs.at(0).sessions.at(0), parts, hooks);
  }
  Eyes eyes{desk.clock};
  test::SlotEvery10ms slots{desk.clock};
};

TEST(HeadsetRecords, HoldEverySlotWithTheFrameThatWasOn) {
  Worn worn(1);
  worn.run();
  EXPECT_EQ(worn.count("headset WHERE runtime = 'a runtime' AND right_height_px = 2200 AND hold = 'image' "
                       "AND left_fov_left_deg = -52 AND refresh_measured_hz = 89.5"),
            1);
  // Two showings of .5 s, with display slots of 10 ms. Frames of 50 and of 20 ms last 5 and 2 slots.
  EXPECT_NEAR(static_cast<double>(worn.count("slot")), 100, 2);
  EXPECT_EQ(worn.count("slot WHERE frame_index IS NULL AND slot_index > 0"), 0) << "black before the first";
  EXPECT_EQ(worn.count("slot s JOIN frame f USING (presentation_id, frame_index) WHERE s.predicted_ns < "
                       "f.scheduled_ns OR s.predicted_ns > f.scheduled_ns + 60000000"),
            0);
  EXPECT_EQ(
      worn.count("(SELECT DISTINCT presentation_id, frame_index FROM slot WHERE frame_index IS NOT NULL)"),
      10 + 25);
  EXPECT_EQ(worn.count("head WHERE x_m = 0.5 AND quat_w = 0.8 AND place_tracked = 1 AND turn_tracked = 0"),
            worn.count("slot"));
  EXPECT_EQ(worn.count("gaze WHERE source = 'tracker' AND tracked = 0 AND direction_x = 0.6 AND origin_z_m = "
                       "0.01 AND device_ns > 0"),
            worn.count("gaze"));
  EXPECT_EQ(worn.count("presentation WHERE gaze_source = 'tracked'"), 2);
}

TEST(HeadsetRecords, OfWhoRefusesGazeHoldNeitherHeadNorEye) {
  Worn worn(0);
  worn.run();
  EXPECT_GT(worn.count("slot"), 90);
  EXPECT_EQ(worn.count("head"), 0);
  EXPECT_EQ(worn.count("gaze"), 0);
  EXPECT_EQ(worn.count("presentation WHERE gaze_source = 'head'"), 2) << "the head stands in";
}

TEST(HeadsetRecords, HoldTheDistanceOfTheEyesWhenItChanges) {
  Worn worn(1);
  std::int64_t begun_ns = -1;
  worn.slots.ipd_of = [&](std::int64_t now_ns) {
    if (begun_ns < 0) begun_ns = now_ns;
    const std::int64_t gone_ms = (now_ns - begun_ns) / 1'000'000;
    return gone_ms < 300 ? 63.0 : gone_ms < 400 ? 63.15 : 64.0;
  };
  // Changes of the distance between the eyes are written in the background, with the frames, so that no frame
  // waits for the disk.
  std::int64_t between_frames = 0;
  SessionHooks hooks;
  hooks.shown = [&](const FrameRecord&) {
    if (worn.count("presentation") == 1) between_frames = worn.count("ipd");
  };
  worn.run(hooks);
  EXPECT_EQ(between_frames, 1);
  EXPECT_THAT(test::column(worn.folder / "study.db", "SELECT ipd_mm FROM ipd ORDER BY ipd_id"),
              ElementsAre("63.0", "64.0"));
}

TEST(HeadsetRecords, HoldWhatHappenedToTheHeadset) {
  Worn worn(1);
  int frames = 0;
  SessionHooks hooks;
  hooks.shown = [&](const FrameRecord&) { ++frames; };
  hooks.request = [&]() -> Request {
    if (frames != 5) return Request::GoOn;
    ++frames;
    worn.slots.news = {"it was lost", "it was made anew"};
    return CutCause::Minimised;
  };
  worn.run(hooks);
  EXPECT_EQ(worn.count("note WHERE words LIKE '%window was minimised: it was lost, it was made anew'"), 1);
  EXPECT_THAT(test::column(worn.folder / "study.db", "SELECT detail FROM event WHERE kind = 'headset'"),
              ElementsAre("it was lost", "it was made anew"));
  EXPECT_EQ(worn.count("presentation WHERE state = 'played'"), 2);
}

TEST(HeadsetRecords, EyesLostForTooLongCutATrialAndAreNoted) {
  for (const auto& [lost_ms, silent] :
       {std::pair{80, false}, std::pair{200, false}, std::pair{80, true}, std::pair{200, true}}) {
    SCOPED_TRACE(silent ? "no samples" : "invalid samples");
    Worn worn(1);
    worn.eyes.silent = silent;
    std::int64_t begun_ns = -1;
    worn.eyes.loses = [&, lost = lost_ms](std::int64_t now_ns) {
      if (begun_ns < 0) begun_ns = now_ns;
      const std::int64_t gone_ms = (now_ns - begun_ns) / 1'000'000;
      return gone_ms > 200 && gone_ms <= 200 + lost;
    };
    worn.run();
    const bool cut = lost_ms > 100;
    EXPECT_EQ(worn.count("presentation WHERE state = 'interrupted'"), cut ? 1 : 0) << lost_ms;
    EXPECT_EQ(worn.count("note WHERE words LIKE '%lost the eyes for over 100 ms%'"), cut ? 1 : 0) << lost_ms;
    EXPECT_EQ(worn.count("presentation WHERE state = 'played'"), 2);
  }
}

TEST(HeadsetRecords, AnAnswerIsKeptWithItsInput) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  Store store(path, Open::Create);
  store.add_run(test::run_plan(test::asking_protocol(), {"P01"}));
  const OpenSession session = store.open_runs().at(0).sessions.at(0);
  const std::vector<KeptAnswer> kept{{"take_part", {test::score(1), 1, AnswerInput::Dwell}},
                                     {gaze_question, {test::score(1), 1, AnswerInput::Keyboard}},
                                     {sharing_question, {test::score(1), 1, {}}}};
  store.answer(session.id, session.units.at(0), 0, kept, true, 900);
  EXPECT_THAT(test::column(path, "SELECT input FROM response ORDER BY response_id"),
              ElementsAre("dwell", "keyboard", "~"));
}

/// The person of each row of headset data, as "table participant".
std::vector<std::string> owners(const fs::path& path) {
  std::vector<std::string> out;
  const std::string of_presentation =
      " JOIN presentation USING (presentation_id) JOIN trial USING (trial_id)";
  for (const auto& [table, joins] :
       {std::pair{"gaze", of_presentation}, std::pair{"gaze_validation", std::string()},
        std::pair{"head", of_presentation}, std::pair{"headset", std::string()},
        std::pair{"ipd", std::string()}, std::pair{"slot", of_presentation}}) {
    for (const std::string& line :
         test::column(path, "SELECT '" + std::string(table) + " ' || participant FROM " + table + joins +
                                " JOIN session USING (session_id) ORDER BY 1"))
      out.push_back(line);
  }
  return out;
}

TEST(HeadsetRecords, OfHeadAndValidationAreRefusedWithoutPermission) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  test::add_people(store, test::asking_protocol(), {{"P01", 0, 1}});
  ShownSlot slot{test::slot_at(6), {}};
  const ValidatedPoint point;
  const auto refused = ThrowsMessage<base::Error>(HasSubstr("who refused it"));
  EXPECT_THAT([&] { store.add_slots(1, 0, {&slot, 1}); }, refused);
  EXPECT_THAT([&] { store.add_validation(1, {&point, 1}, true); }, refused);
  EXPECT_THAT(owners(folder / "study.db"), IsEmpty());
  slot.slot.head.reset();
  store.add_slots(1, 0, {&slot, 1});
  EXPECT_THAT(owners(folder / "study.db"), ElementsAre("slot P01"));
}

TEST(HeadsetRecords, OfWhoTakesGazeBackKeepTheSlotsAlone) {
  const test::TemporaryFolder folder;
  const fs::path path = test::headset_study(folder, "study.db", {{"P01", 1, 1}, {"P02", 1, 1}});
  EXPECT_EQ(change_permissions(path, "P01", {.gaze = false, .sharing = {}}).gaze_deleted, 1);
  EXPECT_THAT(owners(path), ElementsAre("gaze P02", "gaze_validation P02", "head P02", "headset P01",
                                        "headset P02", "ipd P01", "ipd P02", "slot P01", "slot P02"));
}

TEST(HeadsetRecords, GoWithWhoWithdraws) {
  const test::TemporaryFolder folder;
  const fs::path path = test::headset_study(folder, "study.db", {{"P01", 1, 1}, {"P02", 1, 1}});
  withdraw(path, "P01");
  const auto left = owners(path);
  EXPECT_EQ(left.size(), 6u);
  EXPECT_THAT(left, Each(HasSubstr("P02")));
}

TEST(HeadsetRecords, OfTwoStationsAreJoinedAndARefusalAtOneCountsForBoth) {
  const test::TemporaryFolder folder;
  const fs::path north = test::headset_study(folder, "north.db", {{"P01", 1, 1}, {"P02", 1, 1}});
  fs::copy_file(north, folder / "south.db");
  change_permissions(folder / "south.db", "P01", {.gaze = false, .sharing = {}});
  const fs::path other = test::headset_study(folder, "other.db", {{"P07", 1, 1}});
  merge({north, folder / "south.db", other}, folder / "all.db");
  EXPECT_THAT(owners(folder / "all.db"),
              ElementsAre("gaze P02", "gaze P07", "gaze_validation P02", "gaze_validation P07", "head P02",
                          "head P07", "headset P01", "headset P02", "headset P07", "ipd P01", "ipd P02",
                          "ipd P07", "slot P01", "slot P02", "slot P07"));
}

TEST(HeadsetRecords, AreReadOffADamagedDatabase) {
  const test::TemporaryFolder folder;
  const fs::path path = test::headset_study(folder, "study.db", {{"P01", 1, 1}});
  Connection(path, Open::Write).integer("PRAGMA wal_checkpoint(TRUNCATE)");
  const auto before = owners(path);
  ASSERT_EQ(before.size(), 6u);
  std::string bytes = test::bytes_of(path);
  std::fill_n(bytes.begin(), 100, '\0');
  base::write_file_atomically(path, bytes);
  salvage(path, folder / "new.db");
  EXPECT_EQ(owners(folder / "new.db"), before);
  EXPECT_THAT(test::column(folder / "new.db", "SELECT quat_y FROM head"), ElementsAre("0.6"));
}

TEST(HeadsetRecords, ThatWereRefusedSinceAreNotBroughtBackBySalvage) {
  const test::TemporaryFolder folder;
  const fs::path path = test::headset_study(folder, "study.db", {{"P01", 1, 1}, {"P02", 1, 1}});
  Connection(path, Open::Write).integer("PRAGMA wal_checkpoint(TRUNCATE)");
  const std::string old = test::bytes_of(path);
  change_permissions(path, "P01", {.gaze = false, .sharing = {}});
  base::write_file_atomically(path, old);  // the journal beside it has the refusal
  salvage(path, folder / "new.db");
  EXPECT_THAT(owners(folder / "new.db"),
              ElementsAre("gaze P02", "gaze_validation P02", "head P02", "headset P01", "headset P02",
                          "ipd P01", "ipd P02", "slot P01", "slot P02"));
}

TEST(HeadsetRecords, OfTheSchemaBeforeLackWhatItDidNotMeasure) {
  const test::TemporaryFolder folder;
  const fs::path upgraded = folder / "upgraded.db", old = folder / "old.db";
  for (const fs::path& copy : {old, upgraded})
    fs::copy_file(fs::path(VIP_TEST_DIR) / "libstudy/fixtures/study_v4.db", copy);
  const std::string gaze =
      "SELECT source || ' ' || sampled_ns || ' ' || valid || ' ' || coalesce(x, '') FROM gaze ORDER BY 1";
  std::vector<std::string> before;
  {
    Connection database(old, Open::Read);
    for (sqlite::Statement row(database, gaze); row.step();) before.push_back(row.text(0));
  }
  ASSERT_EQ(before.size(), 6u);
  open_database(upgraded, Open::Write, read_schema_steps());
  std::string bytes = test::bytes_of(old);
  std::fill_n(bytes.begin(), 100, '\0');
  base::write_file_atomically(old, bytes);
  salvage(old, folder / "salvaged.db");
  for (const fs::path& now : {upgraded, folder / "salvaged.db"}) {
    EXPECT_EQ(test::column(now, gaze), before) << now;
    EXPECT_THAT(test::column(now, "SELECT coalesce(tracked, direction_x) FROM gaze"), Each("~"));
    EXPECT_THAT(test::column(now, "SELECT gaze_source FROM session ORDER BY session_id"),
                ElementsAre("mouse", "tracked", "fixed"));
    EXPECT_THAT(test::column(now,
                             "SELECT coalesce(input, gaze_source) FROM response JOIN unit u USING "
                             "(unit_id) LEFT JOIN presentation p ON p.trial_id = u.trial_id"),
                Each("~"));
    EXPECT_THAT(owners(now),
                ElementsAre("gaze P01", "gaze P01", "gaze P01", "gaze P02", "gaze P02", "gaze P02"));
  }
}

}  // namespace
}  // namespace study
