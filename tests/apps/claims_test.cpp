/// Hypotheses about methods: those that a protocol tests and the reasons for not testing others, as printed
/// before the study, in the bundle of a preregistration and on the report's page. Also the hypotheses that a
/// plan lists itself, which replace the shipped ones.

#include "libstudy/analysis/claims.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/analysis/plan_file.hpp"
#include "libstudy/analysis/tasks/results.hpp"
#include "libstudy/power/task_power.hpp"
#include "libstudy/preregistration/preregistration.hpp"
#include "libstudy/protocol/method_claims.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/report/page.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/new_file.hpp"
#include "tests/apps/made_task_study.hpp"
#include "tests/apps/study_test_support.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps {
namespace {

using test::replaced;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

std::string own_design() { return test::protocol_text("own_design"); }

/// A design that asks for realism and strain on scales of 1 to 4.
std::string own_realism() {
  return replaced(replaced(own_design(), "ask comfort strain", "ask realism strain"), "id = \"comfort\"",
                  "id = \"realism\"");
}

/// The design with pairs of stimuli, whose question has a third answer, "no difference".
std::string three_way() {
  std::string text = replaced(own_design(), "order = \"shuffle\"", "order = \"shuffle\"\npairs = true");
  text = replaced(text, "\"stimulus\", \"ask comfort strain\"",
                  "\"stimulus first\", \"black 1\", \"stimulus second\", \"ask comfort\"");
  const auto from = text.find("[[block.question]]\nid = \"comfort\"");
  text.replace(from, text.find("[[block]]\nkind = \"debrief\"") - from,
               "[[block.question]]\nid = \"comfort\"\nkind = \"choice\"\ntext = \"Which one?\"\n"
               "anchors = {1 = \"first\", 2 = \"second\", 3 = \"no difference\"}\n\n");
  return text;
}

std::vector<std::string> left_out_of(const std::string& text) {
  std::vector<std::string> out;
  for (const auto& [id, reason, ids] :
       study::hypotheses_of(study::parse_protocol(text, "a.toml"), {}).left_out)
    out.push_back(id + ": " + reason);
  return out;
}

TEST(Claims, RatingsAndPairsHaveReasonsOfTheirOwn) {
  EXPECT_THAT(left_out_of(own_design()),
              ElementsAre(HasSubstr("H1 to H3: the trials ask no question 'realism', "),
                          "H4 to H6: no pairs of methods are shown"));
  EXPECT_THAT(left_out_of(three_way()),
              ElementsAre("H1 to H3: methods are shown in pairs and not rated one by one",
                          "H4 to H6: no question of kind choice with exactly two anchors, one for each of a "
                          "pair, is asked"));
  const auto shipped = [](const std::string& name) { return left_out_of(test::shipped_text(name)); };
  EXPECT_THAT(shipped("task1"), ElementsAre("H4 to H6: no pairs of methods are shown"));
  EXPECT_THAT(shipped("task2"), ElementsAre("H1 to H3: methods are shown in pairs and not rated one by one"));
}

std::string bundle_of(std::vector<std::filesystem::path> protocols) {
  const test::TemporaryFolder folder;
  study::report::BundleRequest request;
  request.protocols = std::move(protocols);
  study::report::freeze_bundle(request, folder / "bundle");
  return base::read_file(folder / "bundle" / "PREREGISTRATION.txt", 1 << 20);
}

TEST(Claims, ABundleNamesWhatNoneOfItsProtocolsTests) {
  EXPECT_THAT(bundle_of({"protocols/task1.toml"}),
              HasSubstr("- Not tested: H4 to H6 of task1: no pairs of methods are shown.\n"));
  EXPECT_THAT(bundle_of({"protocols/task1.toml", "protocols/task2.toml"}), Not(HasSubstr("Not tested")));
}

TEST(Claims, AMarginActsWhereverMethodsAreComparedByItsScore) {
  const test::TemporaryFolder folder;
  base::write_file_atomically(folder / "own.toml", own_realism());
  study::report::BundleRequest request;
  request.protocols = {folder / "own.toml"};
  request.plan.margin_realism = 0.3;
  study::report::freeze_bundle(request, folder / "bundle");
  const auto bundle = study::report::read_bundle(folder / "bundle");
  EXPECT_THAT(bundle.hypotheses, IsEmpty());
  EXPECT_EQ(bundle.plan.plan.margin_realism, 0.3);
  const std::string plan = base::read_file(folder / "bundle" / "plan.toml", 1 << 20);
  EXPECT_THAT(plan, HasSubstr("\nrealism = 0.3"));
  EXPECT_THAT(plan, HasSubstr("# cannot act, as no ratings of cybersickness compare methods: sickness = "));
}

TEST(Claims, ThePageNamesTheProtocolThatDoesNotTestThem) {
  auto own = made_study::task1(6);
  own.name = "comfort";
  own.sha256 = std::string(64, '4');
  own.questions.erase(own.questions.begin());
  const study::Json json = made_study::results_of({{made_study::task1(6), own}, 0});
  ASSERT_EQ(json.at("hypotheses").size(), 3u) << "H1 to H3 of task1";
  std::vector<std::string> lines;
  for (const study::Json& one : json.at("not_analysed"))
    lines.push_back(std::string(one.at("what")) + " of " + std::string(one.at("protocol")));
  EXPECT_THAT(lines, ElementsAre("own design of comfort", "H1 to H3 of comfort", "H4 to H6 of comfort"));
  EXPECT_THAT(study::report::results_page(json), HasSubstr(">comfort</span> (not analysed): "));
}

TEST(Claims, PairsWithThreeAnswersLackTheChoiceOfTwo) {
  auto pairs = made_study::task2(6);
  pairs.questions[0].anchors.emplace_back(3, "no difference");
  const study::Json json = made_study::results_of({{pairs}, 0});
  std::string reasons;
  for (const study::Json& one : json.at("not_analysed")) reasons += std::string(one.at("reason")) + "\n";
  EXPECT_THAT(reasons, AllOf(HasSubstr("exactly two anchors"), HasSubstr("not rated one by one"),
                             Not(HasSubstr("asks no choice"))));
  const auto refused = study::select_task({{pairs}, 0}, {study::TaskKind::Task2, "", {}});
  EXPECT_THAT(refused.reason(), HasSubstr("a choice with exactly two anchors"));
}

study::PlanInForce plan_of(const std::string& text) {
  const test::TemporaryFolder folder;
  base::write_file_atomically(folder / "plan.toml", text);
  auto out = study::read_plan(folder / "plan.toml");
  out.plan.resamples = 200;
  return out;
}

std::string shipped_hypotheses() {
  return base::read_file(base::resource("protocols/plans/paper.toml"), 1 << 20);
}

std::string hypotheses_of_bundle(const stats::AnalysisPlan& plan) {
  const test::TemporaryFolder folder;
  study::report::BundleRequest request;
  request.protocols = {"protocols/task1.toml", "protocols/task2.toml"};
  request.plan = plan;
  study::report::freeze_bundle(request, folder / "bundle");
  return base::read_file(folder / "bundle" / "hypotheses.json", 1 << 20);
}

// The hashes are those of the texts that the program wrote before the hypotheses moved from code to a file.
TEST(Claims, TheShippedFileGivesTheTextsRulesTestsAndMarginsOfTheCodeBeforeIt) {
  EXPECT_EQ(base::sha256_hex(hypotheses_of_bundle({})),
            "98f335271caa2d6fa7ebc10984350206925f8aeb0bb463b25453cba2b79e1f45");
  stats::AnalysisPlan other;
  other.directional = stats::Directional::All;
  other.margin_realism = 1;
  other.margin_sickness = 0.4;
  EXPECT_EQ(base::sha256_hex(hypotheses_of_bundle(other)),
            "f1c04cb257df32b129f10e017f7bc758715d4f1f86a23ea09c279ebeb5bf6bbf");
  const auto listed = plan_of(shipped_hypotheses());
  EXPECT_EQ(hypotheses_of_bundle(listed.plan), hypotheses_of_bundle({})) << "as a plan of one's own";
  const std::string text = study::format_plan(listed.plan, {"ab"});
  EXPECT_EQ(study::format_plan(plan_of(text).plan, {"ab"}), text);
}

TEST(Claims, ThePapersProcedureAndItsLargerFamiliesAreThoseOfTheCodeBeforeTheFile) {
  const auto json = made_study::results_of({{made_study::task1(12), made_study::task2(12)}, 0});
  for (const auto& hypothesis : json.at("hypotheses")) {
    const std::string id = hypothesis.at("id");
    for (const auto& test : hypothesis.at("tests")) {
      const bool differs = test.at("paper_p").get<double>() < 0.05;
      const double estimate = test.at("estimate"), none = test.contains("score") ? 0 : 0.5;
      const bool better = test.value("score", "") == "sickness" ? estimate < none : estimate > none;
      const bool confirmed = id == "H2" || id == "H6" ? !differs
                             : id == "H3"             ? !differs || better
                                                      : differs && better;
      EXPECT_EQ(test.at("paper_holds"), confirmed) << id << ": " << test.at("label");
      EXPECT_EQ(test.contains("p_holm_of_five") && test.contains("p_holm_of_ten"), id == "H4" || id == "H5");
    }
  }
}

/// The paper's file without its third hypothesis. The first hypothesis has another name, margin and
/// direction.
std::string changed_hypotheses() {
  std::string text = shipped_hypotheses();
  const auto third = text.find("[[hypothesis]]\nid = \"H3\"");
  text.erase(third, text.find("[[hypothesis]]\nid = \"H4\"") - third);
  text = replaced(text, "id = \"H1\"", "id = \"worse\"");
  text = replaced(text, "alternative = \"better\"", "alternative = \"worse\"");
  return replaced(text, "margin = \"plan\"", "margin = {realism = 3, sickness = 1.5}");
}

TEST(Claims, APlanThatListsOthersChangesTheResultsAsItSays) {
  const study::TaskStudy study{{made_study::task1(12), made_study::task2(12)}, 0};
  const auto shipped = made_study::results_of(study),
             own = made_study::results_of(study, plan_of(changed_hypotheses()));
  const auto& list = own.at("hypotheses");
  ASSERT_EQ(list.size(), 5u);
  EXPECT_EQ(list[0].at("id"), "worse");
  EXPECT_EQ(list[0].at("tests")[0].at("label"), "FovFluid - Ours, realism, 16k");
  EXPECT_EQ(list[0].at("tests")[0].at("estimate").get<double>(),
            -shipped.at("hypotheses")[0].at("tests")[0].at("estimate").get<double>());
  EXPECT_EQ(list[1].at("id"), "H2");
  EXPECT_EQ(list[1].at("tests")[0].at("margin"), 3);
  EXPECT_EQ(list[1].at("status"), "supported") << "within half of the scale";
  EXPECT_NE(shipped.at("hypotheses")[1].at("status"), "supported");
  EXPECT_EQ(list[2], [&] {
    auto same = shipped.at("hypotheses")[3];
    same["p_claim_of_six"] = list[2].at("p_claim_of_six");
    return same;
  }()) << "what was not changed";
  EXPECT_EQ(own.at("sensitivity")[0].at("hypotheses").size(), 2u);
  EXPECT_EQ(own.at("plan").at("hypotheses").size(), 5u);
  EXPECT_FALSE(shipped.at("plan").contains("hypotheses"));
  const std::string page = study::report::results_page(own);
  EXPECT_NE(page.find(">worse</span>"), std::string::npos);
  EXPECT_EQ(page.find(">H3</span>"), std::string::npos);
}

TEST(Claims, HypothesesAboutATaskWithoutAnswersAreNamed) {
  const study::TaskStudy study{{made_study::task2(12)}, 0};
  const auto own = made_study::results_of(study, plan_of(changed_hypotheses()));
  ASSERT_EQ(own.at("not_analysed").size(), 1u);
  EXPECT_EQ(own.at("not_analysed")[0].at("what"), "worse and H2");
  EXPECT_EQ(own.at("not_analysed")[0].at("task"), "task1");
  EXPECT_EQ(made_study::results_of(study).at("not_analysed").size(), 0u) << "no plan, no promise";
}

TEST(Claims, PreregistrationAndPowerUseThePlansOwn) {
  const auto own = plan_of(changed_hypotheses());
  EXPECT_THAT(hypotheses_of_bundle(own.plan), AllOf(HasSubstr("\"worse\""), Not(HasSubstr("\"H3\""))));
  study::PowerRequest request;
  request.protocol = study::read_protocol(base::resource("protocols/task1.toml"));
  request.n = {8};
  request.studies = 5;
  request.worlds = {"null", "paper"};
  request.plan = own;
  for (const auto& world : study::simulate_task_power(request)) {
    ASSERT_EQ(world.hypotheses.size(), 2u);
    EXPECT_EQ(world.hypotheses[0].id, "worse");
    EXPECT_EQ(world.hypotheses[0].claims_true, 0) << world.words;
    EXPECT_EQ(world.hypotheses[1].tests[0].margin, 3);
  }
  request.worlds = {"margin"};
  EXPECT_THAT(
      [&] { study::simulate_task_power(request); },
      ::testing::ThrowsMessage<base::Error>(HasSubstr("is not made for the methods or margins of worse")));
}

TEST(Claims, MistakesInTheirTablesAreRefusedAtTheirPlace) {
  const std::string good =
      "format = 1\n[[hypothesis]]\nid = \"a\"\ntext = \"t\"\ntask = \"task1\"\noutcome = \"realism\"\n"
      "compare = [{method = \"Ours\"}, {method = \"HiRes\"}]\ntest = \"paired_t\"\nalternative = "
      "\"better\"\n";
  EXPECT_EQ(plan_of(good).plan.claims.size(), 1u);
  const auto refuse = [&](const char* from, const char* to, const char* words) {
    try {
      plan_of(replaced(good, from, to));
      ADD_FAILURE() << to;
    } catch (const base::Error& error) {
      EXPECT_THAT(error.what(), AllOf(HasSubstr("plan.toml:"), HasSubstr(words))) << to;
    }
  };
  refuse("\"Ours\"", "\"Ourz\"", "plan.toml:7:");
  refuse("\"Ours\"", "\"Ourz\"", "the nearest is \"Ours\"");
  refuse("\"HiRes\"", "[\"Ours\", \"HiRes\"]", "compares Ours with itself");
  refuse("\"HiRes\"", "[\"HiRes\", \"HiRes\"]", "is listed twice");
  refuse(", {method = \"HiRes\"}", "", "holds 1 tables");
  refuse("task1", "task3", "plan.toml:5:");
  refuse("\"realism\"", "\"choice\"", "is no outcome of this task");
  refuse("\"paired_t\"", "\"binomial\"", "plan.toml:8:");
  refuse("\"paired_t\"", "\"tost\"", "needs a margin");
  refuse("\"better\"", "\"two-sided\"", "plan.toml:9:");
  refuse("test = ", "margin = \"wide\"\ntest = ", "plan.toml:8:");
  refuse("test = ", "margin = {realism = -1}\ntest = ", "plan.toml:8:");
  refuse("test = ", "margin = {realism = 1, sickness = 1}\ntest = ", "sickness");
  refuse("test = ", "margin = {realism = 6}\ntest = ", "plan.toml:8:");
  refuse("format = 1\n", "format = 1\n[margins]\nsickness = 3\n", "plan.toml:3:");
  refuse("test = ", "family = \"f\"\ntest = ", "family");
  refuse("text = \"t\"\n", "", "text");
  refuse("format = 1\n", ("format = 1\n" + good.substr(11)).c_str(), "is the id of another hypothesis");
  refuse("format = 1\n", "format = 1\ndirectional = \"a\"\n", "use true or false");
}

}  // namespace
}  // namespace apps
