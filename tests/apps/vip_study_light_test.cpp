/// vip-study light: a sensor's log from the file to the certificate.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/file/sqlite.hpp"
#include "tests/apps/study_test_support.hpp"
#include "tests/libstudy/lit_study.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class VipStudyLightE2e : public ::testing::Test {
 protected:
  Ended light(const std::string& text, const std::vector<std::string>& more = {}) {
    base::write_file_atomically(log_, text);
    std::vector<std::string> all{vip_study, "light", log_, "--db", database_};
    all.insert(all.end(), more.begin(), more.end());
    return run_program(all);
  }
  std::int64_t rows() const {
    return study::sqlite::Connection(database_, study::sqlite::Open::Read)
        .integer("SELECT count(*) FROM light");
  }
  const TemporaryFolder folder_;
  const std::string database_ = folder_ / "study.db", log_ = folder_ / "log.csv";
  const std::vector<study::RecordedShowing> showings_ = study::test::light_showings(6, 60);
};

TEST_F(VipStudyLightE2e, ALogRaisesTheCertificateAndSaysWhyNot) {
  study::test::lit_study(database_, showings_);
  study::test::LightWorld world;
  world.drift_ppm = 120;
  world.jitter_ms = 0.2;
  world.missed = {{4, 20}};
  const auto ended =
      light("time_ms,level\n" + study::test::light_csv(study::test::light_log(showings_, world)));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out,
              AllOf(HasSubstr("samples: time in ms from column 'time_ms'"),
                    HasSubstr("P01, visit 1: 6 of 6 showings in the log"),
                    HasSubstr("lag: relative to the median showing; without triggers"), HasSubstr("D -> A"),
                    HasSubstr("D -> D: 1 frames missed; 1 onsets hidden by them (frames 20)"),
                    HasSubstr("showings now: 5 of grade A, 1 of grade D; stored in ")));
  EXPECT_EQ(rows(), 6);
  EXPECT_THAT(ended.out, HasSubstr("Timing certificate of")) << "with the raised grades";
  const auto again = light("time_ms,level\n" + study::test::light_csv(study::test::light_log(showings_, {})));
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("showings now: 6 of grade A"));
  EXPECT_EQ(rows(), 6) << "a later log replaces an earlier one";
}

TEST_F(VipStudyLightE2e, AnArduinosLogWithTriggersGivesTheAbsoluteLag) {
  study::test::lit_study(database_, showings_);
  study::test::LightWorld world;
  world.lag_ms = 25;
  for (const auto& showing : showings_) world.triggers_ns.push_back(showing.onsets_ns.front());
  {
    study::sqlite::Connection database(database_, study::sqlite::Open::Write);
    study::sqlite::Statement insert(database,
                                    "INSERT INTO marker SELECT NULL, 1, 'serial:x', 'stimulus_onset', 3, 0, "
                                    "0, 1, 1, ?, NULL, '', 0, NULL");
    for (const std::int64_t ns : world.triggers_ns) insert.bind_all(ns).run();
  }
  const auto text = study::test::light_csv(study::test::light_log(showings_, world), 1e-6);
  EXPECT_THAT(light(text, {"--unit", "us"}).err, HasSubstr("--columns 1,2,3"));
  const auto ended = light(text, {"--unit", "us", "--columns", "1,2,3"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("lag: from the record's onset to light, by 6 triggers"));
  study::sqlite::Connection database(database_, study::sqlite::Open::Read);
  EXPECT_EQ(database.integer("SELECT count(*) FROM light WHERE lag_absolute AND abs(lag_ms - 25) < 0.5"), 6);
}

TEST_F(VipStudyLightE2e, WhatProvesNothingIsRefusedAndStoresNothing) {
  study::test::lit_study(database_, showings_, "P01", "{}");
  const std::string text = "time_ms,level\n" + study::test::light_csv(study::test::light_log(showings_, {}));
  const auto no_patch = light(text);
  EXPECT_EQ(no_patch.exit_code, 1);
  EXPECT_THAT(no_patch.err, HasSubstr("no session of it was run with --light-patch"));
  study::test::lit_study(database_, study::test::light_showings(6, 60, 7), "P02");
  const auto wrong = light(text);
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.err, AllOf(HasSubstr("does not fit a session of"), HasSubstr("P02, visit 1: ")));
  EXPECT_THAT(light(text, {"--participant", "P01"}).err, HasSubstr("no session of P01 was run with"));
  EXPECT_THAT(light(text, {"--participant", "P08"}).err, HasSubstr("has no session of P08"));
  EXPECT_THAT(light("time_ms,level\n1,5\n2,5\n3,5\n").err, HasSubstr("does not change between two levels"));
  EXPECT_THAT(light(text, {"--unit", "s"}).err, HasSubstr("contradicts"));
  EXPECT_EQ(rows(), 0);
}

TEST_F(VipStudyLightE2e, ALogThatIsInvertedNeedsItsOption) {
  study::test::lit_study(database_, showings_);
  study::SensorLog log = study::test::light_log(showings_, {});
  for (float& level : log.level) level = 1000 - level;
  const std::string text = "time_ms,level\n" + study::test::light_csv(log);
  EXPECT_THAT(light(text).err, HasSubstr("--inverted"));
  const auto ended = light(text, {"--inverted"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("showings now: 6 of grade A"));
}

}  // namespace
}  // namespace apps::test
