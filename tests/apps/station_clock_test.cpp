/// A station with a wrong clock: reported before the session, and not mistaken for a late preregistration.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/study/station_warnings.hpp"
#include "libstudy/analysis/tasks/results.hpp"
#include "libstudy/preregistration/bundle_parts.hpp"
#include "libstudy/preregistration/preregistration.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "stats/base/utc.hpp"
#include "tests/apps/made_task_study.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace apps {
namespace {

using study::sqlite::Open;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(StationClock, IsComparedWithTheBuildAndTheNewestRow) {
  const std::string newest = "2026-05-01T12:00:00Z", built = "2026-01-01T00:00:00Z";
  for (const char* now : {"2026-05-01T12:00:00Z", "2026-05-01T11:59:30Z", "2027-04-30T00:00:00Z"})
    EXPECT_EQ(clock_problem(now, newest, built), "") << now;
  EXPECT_EQ(clock_problem("2026-05-01T12:00:00Z", "", built), "");
  for (const char* now : {"1969-12-31T23:00:00Z", "2025-12-31T23:59:59Z"})
    EXPECT_THAT(clock_problem(now, "", built), HasSubstr("before this program was built, on 2026-01-01"));
  EXPECT_THAT(clock_problem("2026-05-01T11:58:00Z", newest, built),
              AllOf(HasSubstr("before the newest row"), HasSubstr(newest), HasSubstr("mend: set the clock")));
  EXPECT_THAT(clock_problem("2027-06-01T00:00:00Z", newest, built), HasSubstr("more than a year after"));
}

/// Records a finished session at this time of the clock.
void record(const std::filesystem::path& path, const std::string& code, const std::string& utc) {
  const base::FixedUtc clock(utc);
  study::Store store(path, Open::Create);
  store.add_run(study::test::run_plan(study::test::pilot(), {code}));
  for (const study::OpenRun& run : store.open_runs())
    for (const study::OpenSession& session : run.sessions) study::test::finish_pilot(store, session, 4);
}

TEST(StationClock, TheExperimenterIsToldBeforeTheSession) {
  const ::test::TemporaryFolder folder;
  record(folder / "s.db", "P01", "2999-05-01T12:00:00Z");
  study::Store store(folder / "s.db", Open::Write);
  {
    const base::FixedUtc clock("1969-12-31T23:00:00Z");
    ::testing::internal::CaptureStderr();
    EXPECT_THAT(warn_of_station(store, folder / "s.db"), ElementsAre(HasSubstr("1969-12-31T23:00:00Z")));
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("warning: the clock of this computer"));
  }
  const base::FixedUtc clock("2999-05-02T12:00:00Z");
  EXPECT_THAT(warn_of_station(store, folder / "s.db"), IsEmpty());
}

study::TaskSession session_of(const std::filesystem::path& path, const std::string& code) {
  for (const auto& protocol : study::read_tasks(path).protocols)
    for (const auto& session : protocol.sessions)
      if (session.participant == code) return session;
  return {};
}

TEST(StationClock, TheOrderOfRowsIsKeptWithTheSessionAndSurvivesAMerge) {
  const ::test::TemporaryFolder folder;
  record(folder / "a.db", "P01", "2026-05-01T12:00:00Z");
  record(folder / "a.db", "P02", "1969-12-31T23:00:00Z");
  record(folder / "b.db", "P03", "2026-04-01T12:00:00Z");
  study::merge({folder / "a.db", folder / "b.db"}, folder / "all.db");
  for (const char* file : {"a.db", "all.db"}) {
    EXPECT_EQ(session_of(folder / file, "P02").first_answer_utc, "1969-12-31T23:00:00Z");
    EXPECT_EQ(session_of(folder / file, "P02").not_before_utc, "2026-05-01T12:00:00Z");
    EXPECT_EQ(session_of(folder / file, "P01").not_before_utc, "2026-05-01T12:00:00Z");
  }
}

/// Compares Task 1 with a bundle frozen now. The first answer of one session is recorded at the time `told`,
/// although its database has earlier rows with the time `not_before`.
base::Json compared(const std::string& told, const std::string& not_before) {
  const ::test::TemporaryFolder folder;
  study::report::BundleRequest request;
  request.protocols = {"protocols/task1.toml"};
  request.plan.resamples = 200;
  study::report::freeze_bundle(request, folder / "bundle");
  const auto bundle = study::report::read_bundle(folder / "bundle");
  auto task = made_study::task1(12);
  const auto protocol = study::read_protocol(base::resource("protocols/task1.toml"));
  task.sha256 = protocol.sha256;
  for (auto& session : task.sessions) session.first_answer_utc = "2999-12-31T00:00:00Z";
  task.sessions[7].first_answer_utc = told;
  task.sessions[7].not_before_utc = not_before;
  const auto results =
      study::make_results({{task}, 0}, {"study.db", {study::TaskKind::Task1}, "", bundle.plan}).json;
  study::ProtocolRow row;
  row.name = protocol.name;
  row.version = protocol.version;
  row.sha256 = protocol.sha256;
  row.text = protocol.text;
  return study::report::compare_with_bundle(bundle, {row}, results);
}

TEST(StationClock, WhereAnImpossibleTimeFollowsLaterRowsTheOrderDecides) {
  const auto check = compared("1969-12-31T23:00:00Z", "2999-01-01T00:00:00Z");
  const auto& time = check.at("times").at(0);
  EXPECT_EQ(time.at("frozen_before"), true);
  EXPECT_EQ(time.at("clocks_disagree"), true);
  EXPECT_THAT(time.at("text").dump(), HasSubstr("by the order of the rows the bundle is older"));
  EXPECT_TRUE(check.at("tasks").at("task1").get<bool>()) << check.dump(2);
}

TEST(StationClock, AFirstAnswerThatIsNoPersonsSaysSo) {
  const auto text = [](int simulated, bool test_data) {
    const base::Json used{{"task", "own"},
                          {"title", "Own design"},
                          {"first_answer_utc", "2026-04-01T00:00:00Z"},
                          {"simulated", simulated},
                          {"test_data", test_data}};
    return std::string(study::report::time_json("2026-05-01T00:00:00Z", used).at("text"));
  };
  const std::string given =
      "The bundle was not frozen before the first answer of Own design, given 2026-04-01T00:00:00Z";
  EXPECT_EQ(text(0, false), given + ".");
  EXPECT_EQ(text(3, false), given + " by an observer model.");
  EXPECT_EQ(text(0, true), given + " as test data.");
}

TEST(StationClock, WhereTheOrderDoesNotTellNothingIsCalledLate) {
  // Time of the first answer, and of earlier rows. First pair: the earlier rows are older than the bundle, so
  // they tell nothing. Second pair: both times are possible.
  const std::pair<const char*, const char*> cases[] = {{"1969-12-31T23:00:00Z", "2025-01-01T00:00:00Z"},
                                                       {"2025-01-01T00:00:00Z", "2999-01-01T00:00:00Z"}};
  for (const auto& [told, not_before] : cases) {
    const auto check = compared(told, not_before);
    const auto& time = check.at("times").at(0);
    EXPECT_TRUE(time.at("frozen_before").is_null()) << check.dump(2);
    EXPECT_THAT(time.at("text").dump(),
                AllOf(HasSubstr("cannot be told"), Not(HasSubstr("not frozen before"))));
    EXPECT_FALSE(check.at("tasks").at("task1").get<bool>());
    EXPECT_THAT(check.at("summary").dump(), HasSubstr("cannot be told, as clocks disagree"));
  }
}

// A correction of the clock by five seconds is no contradiction.
TEST(StationClock, ASmallStepIsNoContradiction) {
  const auto check = compared("2025-01-01T00:00:00Z", "2025-01-01T00:00:05Z");
  EXPECT_EQ(check.at("times").at(0).at("frozen_before"), false);
  EXPECT_EQ(check.at("times").at(0).at("clocks_disagree"), false);
}

}  // namespace
}  // namespace apps
