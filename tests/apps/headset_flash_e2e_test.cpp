/// Nothing flashes in a headset, whatever trouble repeats: checked in the simulated headset's own log.
#include <sstream>

#include "libstudy/session/repeats.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "tests/apps/headset_runs.hpp"
#include "tests/libstudy/permission_fixture.hpp"

namespace apps {
namespace {

namespace fs = std::filesystem;
using study::CutCause;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class HeadsetFlashE2e : public test::HeadsetRuns {
 protected:
  void SetUp() override { bake_dam(dam_, 60); }

  /// Two showings of half a second after a consent page. The protocol asks for no black between them.
  test::Ended session(const std::string& profile, const std::string& gaze,
                      const std::string& clock = "virtual") {
    base::write_file_atomically(folder_ / "asking.toml", test::asking_at_60());
    fs::remove(database_);
    fs::remove(database_ + ".answers.jsonl");
    return study("size=32x32;" + profile,
                 {"run", folder_ / "asking.toml", "--db", database_, "--observer", "constant:1", "--display",
                  "openxr", "--clock", clock, "--stimulus", dam_, "--participants", "1", "--gaze", gaze});
  }
  std::int64_t count(const std::string& rows) const {
    return study::sqlite::Connection(database_, study::sqlite::Open::Read)
        .integer("SELECT count(*) FROM " + rows);
  }
  std::vector<std::string> causes() const {
    return study::test::column(database_, "SELECT detail FROM event WHERE kind = 'trial interrupted'");
  }
  /// Times at which the stimulus appears and disappears, on the session's clock, ns, from the database.
  std::vector<std::int64_t> changes() const {
    std::vector<std::int64_t> all;
    study::sqlite::Connection database(database_, study::sqlite::Open::Read);
    study::sqlite::Statement row(database,
                                 "SELECT start_ns AS t FROM presentation UNION ALL SELECT end_ns FROM "
                                 "presentation WHERE end_ns IS NOT NULL UNION ALL SELECT clock_ns FROM event "
                                 "WHERE kind = 'trial interrupted' ORDER BY t");
    while (row.step()) all.push_back(row.integer(0));
    return all;
  }

  const std::string dam_ = folder_ / "dam.bake", database_ = folder_ / "study.db";
};

/// A script that repeats from slot 60 on: `bad`, and 20 slots later `good`.
std::string again_and_again(const std::string& bad, const std::string& good) {
  std::string script = "at=";
  for (int slot = 60; slot < 1200; slot += 40) {
    script += (slot > 60 ? "," : "") + std::to_string(slot) + ":" + bad;
    if (!good.empty()) script += "," + std::to_string(slot + 20) + ":" + good;
  }
  return script;
}

TEST_F(HeadsetFlashE2e, WhatGoesWrongAgainAndAgainIsShownFourTimesAtMostAndFlashesNever) {
  struct Trouble {
    std::string bad, good;
    CutCause cause;
  };
  for (const auto& [bad, good, cause] : std::vector<Trouble>{
           {"focus/0", "focus/1", CutCause::Focus},
           // No pictures are wanted before the session reports its new state, which says why.
           {"shown/0", "shown/1", CutCause::TakenOff},
           {"render/0", "render/1", CutCause::NotDrawn},
           {"orientation/0", "orientation/1", CutCause::Pose},
           {"recentre/5", "", CutCause::Recentred},
           {"gaze_valid/0", "gaze_valid/1", CutCause::Gaze}}) {
    const bool tracked = cause == CutCause::Gaze;
    const auto ended = session(again_and_again(bad, good), tracked ? "tracked" : "fixed");
    EXPECT_EQ(ended.exit_code, 1) << bad << ended.out;
    EXPECT_THAT(ended.err, AllOf(HasSubstr("cut 4 times"), HasSubstr("vip-study resume continues"))) << bad;
    EXPECT_EQ(count("presentation WHERE state = 'interrupted'"), study::most_repeats + 1) << bad;
    EXPECT_THAT(causes(), Each(::testing::StartsWith(words_of(cause).happened))) << bad;
    const std::vector<std::int64_t> times = changes();
    EXPECT_GE(times.size(), 2u * (study::most_repeats + 1)) << bad;
    for (std::size_t i = 3; i < times.size(); ++i)
      EXPECT_GE(times[i] - times[i - 3], 1'000'000'000) << bad << ": three changes in a second";
  }
}

TEST_F(HeadsetFlashE2e, WithoutTheEyesNothingIsShown) {
  const auto blind = session("gaze_valid=0", "tracked");
  EXPECT_EQ(blind.exit_code, 1);
  EXPECT_THAT(blind.err, HasSubstr("the eye tracker does not see the eyes"));
  EXPECT_EQ(count("presentation"), 0);
  EXPECT_TRUE(changes().empty());
  const auto again = study("size=32x32", {"resume", "--db", database_});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(count("presentation WHERE state = 'played'"), 2);
  // The extension is listed, and no sample ever comes.
  const auto real = session("clock=real;rates=60;rate=60;gaze_active=0", "tracked", "real");
  EXPECT_EQ(real.exit_code, 1);
  EXPECT_THAT(real.err, HasSubstr("the eye tracker does not see the eyes"));
  EXPECT_EQ(count("presentation"), 0);
  // The gaze is lost for good during the showing.
  const auto lost = session("at=45:gaze_valid/0", "tracked");
  EXPECT_EQ(lost.exit_code, 1);
  EXPECT_THAT(lost.err, HasSubstr("the eye tracker does not see the eyes"));
  EXPECT_EQ(changes().size(), 2u);
  EXPECT_THAT(causes(), ElementsAre(words_of(CutCause::Gaze).happened));
}

}  // namespace
}  // namespace apps
