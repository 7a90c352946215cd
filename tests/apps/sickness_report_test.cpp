/// Sickness in the results and on the page.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "libstudy/analysis/tasks/csv.hpp"
#include "libstudy/analysis/tasks/sickness_json.hpp"
#include "libstudy/report/page.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps {
namespace {

using study::FmsAnswer;
using study::SicknessSession;
using study::SsqPage;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

stats::AnalysisPlan quick_plan() {
  stats::AnalysisPlan plan;
  plan.resamples = 200;
  return plan;
}

SsqPage page(bool before, int answer) {
  SsqPage out;
  out.before = before;
  out.block = before ? "ssq_before" : "ssq_after";
  out.answers.fill(answer);
  return out;
}

SicknessSession session(const std::string& participant, std::vector<SsqPage> ssq, std::vector<int> fms) {
  SicknessSession out;
  out.protocol_name = "task1_lab";
  out.protocol_sha256 = std::string(64, '1');
  out.participant = participant;
  out.ssq = std::move(ssq);
  for (const int score : fms) {
    const int place = static_cast<int>(out.fms.size());
    out.fms.push_back({place, place == 0 ? "sickness" : "ratings", {}, "", 2. * place, score});
  }
  return out;
}

/// Three people, one of whom left before the last pages.
std::vector<SicknessSession> three() {
  return {session("P01", {page(true, 0), page(false, 3)}, {0, 4, 8}),
          session("P02", {page(true, 1), page(false, 1)}, {2, 2, 2}),
          session("P03", {page(true, 2)}, {1, 13})};
}

const study::Json& score(const study::Json& sickness, std::size_t i) {
  return sickness.at(0)["ssq"]["scores"].at(i);
}

TEST(SicknessJson, DescribesAllAndComparesThoseWithBoth) {
  const study::Json json = study::sickness_json(three(), quick_plan());
  ASSERT_THAT(json, SizeIs(1));
  EXPECT_EQ(json[0]["participants"], 3);
  const study::Json& total = score(json, 3);
  EXPECT_EQ(total["score"], "total");
  EXPECT_EQ(total["max"], 235.62);
  EXPECT_EQ(total["before"]["n"], 3);
  EXPECT_EQ(total["after"]["n"], 2);
  EXPECT_EQ(total["after"]["max"], 235.62);
  EXPECT_EQ(total["change"]["n"], 2);
  EXPECT_EQ(total["change"]["n_missing"], 1);
  EXPECT_NEAR(total["change"]["mean"].get<double>(), 235.62 / 2, 1e-9);
  EXPECT_EQ(total["change"]["wilcoxon"]["n_zero"], 1);
}

TEST(SicknessJson, FmsIsToldByBlockAndByAsking) {
  const study::Json fms = study::sickness_json(three(), quick_plan())[0]["fms"];
  EXPECT_EQ(fms["answers"], 8);
  EXPECT_EQ(fms["peak"]["max"], 13);
  EXPECT_EQ(fms["mean"]["median"], 4);
  ASSERT_THAT(fms["blocks"], SizeIs(2));
  EXPECT_EQ(fms["blocks"][1]["block"], "ratings");
  EXPECT_EQ(fms["blocks"][1]["peak"]["median"], 8);
  ASSERT_THAT(fms["times"], SizeIs(3));
  EXPECT_EQ(fms["times"][2]["n"], 2);
  EXPECT_EQ(fms["times"][2]["minutes"], 4);
  EXPECT_EQ(fms["change"]["median"], 8) << "8, 0 and 12";
}

TEST(SicknessJson, AMissingItemIsCountedAndEmptiesItsScales) {
  auto sessions = three();
  sessions[0].ssq[1].answers[6] = {};  // the item sweating has no answer
  const study::Json json = study::sickness_json(sessions, quick_plan());
  EXPECT_EQ(json[0]["ssq"]["incomplete"], 1);
  EXPECT_EQ(score(json, 0)["change"]["n"], 1);
  EXPECT_EQ(score(json, 1)["change"]["n"], 2);
  EXPECT_EQ(score(json, 3)["change"]["n"], 1);
  EXPECT_TRUE(json[0]["scores"][0]["ssq_nausea_after"].is_null());
}

TEST(SicknessJson, VisitsOfOnePersonAreOneValue) {
  auto sessions = three();
  sessions.insert(sessions.begin() + 1, session("P01", {page(true, 1), page(false, 2)}, {}));
  sessions[1].visit = 2;
  const study::Json json = study::sickness_json(sessions, quick_plan());
  EXPECT_EQ(score(json, 3)["change"]["n"], 2);
  EXPECT_NEAR(json[0]["scores"][0]["ssq_total_after"].get<double>(), 235.62 * 5 / 6, 1e-9);
}

TEST(SicknessJson, TestDataAndSimulatedPeopleStepBack) {
  auto sessions = three();
  sessions[0].test_data = true;
  EXPECT_EQ(study::sickness_json(sessions, quick_plan())[0]["participants"], 2);
  sessions[1].observer = "random";
  const study::Json people = study::sickness_json(sessions, quick_plan());
  EXPECT_EQ(people[0]["participants"], 1);
  EXPECT_EQ(people[0]["simulated"], 0);
  for (SicknessSession& one : sessions) one.observer = "random";
  EXPECT_EQ(study::sickness_json(sessions, quick_plan())[0]["simulated"], 2);
}

TEST(SicknessJson, ProtocolsAreNeverPooled) {
  auto sessions = three();
  sessions[2].protocol_sha256 = std::string(64, '2');
  EXPECT_THAT(study::sickness_json(sessions, quick_plan()), SizeIs(2));
  EXPECT_THAT(study::sickness_json({}, quick_plan()), SizeIs(0));
}

TEST(SicknessTables, HoldEveryNumber) {
  auto plan = quick_plan();
  plan.confidence = 0.5;  // three people support no higher level
  const study::Json json{{"timing", study::Json::array()},
                         {"hypotheses", study::Json::array()},
                         {"sensitivity", study::Json::array()},
                         {"exclusions", study::Json::array()},
                         {"sickness", study::sickness_json(three(), plan)}};
  std::map<std::string, std::string> files;
  const test::TemporaryFolder folder;
  study::write_csv_folder(json, folder / "tables",
                          [&](const std::filesystem::path& path, const std::string& bytes) {
                            files[path.filename().string()] = bytes;
                          });
  EXPECT_THAT(files["sickness_ssq.csv"], HasSubstr("change_bca_low,change_bca_high"));
  EXPECT_THAT(files["sickness_ssq.csv"], HasSubstr("\r\ntask1_lab,total,Total,3.74,235.62,3,"));
  EXPECT_THAT(files["sickness_fms_blocks.csv"], HasSubstr("\r\ntask1_lab,ratings,3,"));
  EXPECT_THAT(files["sickness_fms_times.csv"], HasSubstr("\r\ntask1_lab,3,4"));
  EXPECT_THAT(files["sickness_participants.csv"], HasSubstr("\r\ntask1_lab,P03,"));
}

std::string html_of(const std::vector<SicknessSession>& sessions) {
  study::Json json{{"schema", "vip-results/1"}, {"sickness", study::sickness_json(sessions, quick_plan())}};
  return study::report::results_page(json);
}

// A model answers within milliseconds; an earlier version printed 0.0 minutes for every rating.
TEST(SicknessSection, WhoIsSimulatedHasNoMinutes) {
  EXPECT_THAT(html_of(three()), HasSubstr("Minutes (median)"));
  auto sessions = three();
  for (auto& one : sessions) one.observer = "random";
  EXPECT_TRUE(study::sickness_json(sessions, quick_plan())[0]["fms"]["times"][2]["minutes"].is_null());
  EXPECT_THAT(html_of(sessions), Not(HasSubstr("Minutes (median)")));
}

TEST(SicknessSection, SaysWhatIsMissingOnlyWhereItIs) {
  auto sessions = three();
  EXPECT_THAT(html_of(sessions), Not(HasSubstr("missing item")));
  sessions[0].ssq[1].answers[6] = {};
  EXPECT_THAT(html_of(sessions), HasSubstr("missing item"));
}

TEST(SicknessSection, SaysWhereTheQuestionnaireWasAskedOnce) {
  EXPECT_THAT(html_of(three()), Not(HasSubstr("No session answered")));
  auto sessions = three();
  for (SicknessSession& one : sessions)
    std::erase_if(one.ssq, [](const SsqPage& page) { return !page.before; });
  const auto before = html_of(sessions);
  EXPECT_THAT(before, HasSubstr("after the first trial, so"));
  EXPECT_THAT(before, Not(HasSubstr("Changes of the SSQ scores")));
  EXPECT_THAT(before, Not(HasSubstr(">After<")));
  sessions = three();
  for (SicknessSession& one : sessions)
    std::erase_if(one.ssq, [](const SsqPage& page) { return page.before; });
  EXPECT_THAT(html_of(sessions), HasSubstr("before the first trial, so"));
}

TEST(SicknessSection, ShowsOnlyWhatWasAsked) {
  auto sessions = three();
  for (SicknessSession& one : sessions) one.fms.clear();
  EXPECT_THAT(html_of(sessions), Not(HasSubstr("Fast Motion Sickness")));
  EXPECT_THAT(html_of(sessions), HasSubstr("Simulator Sickness"));
  sessions = three();
  for (SicknessSession& one : sessions) one.ssq.clear();
  EXPECT_THAT(html_of(sessions), HasSubstr("Fast Motion Sickness"));
  EXPECT_THAT(html_of(sessions), Not(HasSubstr("Simulator Sickness")));
  EXPECT_THAT(html_of({}), Not(HasSubstr("id=\"sickness\"")));
}

TEST(SicknessSection, NamesTestDataAndSimulatedPeople) {
  auto sessions = three();
  EXPECT_THAT(html_of(sessions), Not(HasSubstr("test data")));
  EXPECT_THAT(html_of(sessions), Not(HasSubstr("answered by a model")));
  for (SicknessSession& one : sessions) one.test_data = true;
  EXPECT_THAT(html_of(sessions), HasSubstr("test data"));
  for (SicknessSession& one : sessions) one.observer = "random";
  EXPECT_THAT(html_of(sessions), HasSubstr("answered by a model"));
}

}  // namespace
}  // namespace apps
