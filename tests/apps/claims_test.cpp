/// Which of H1 to H6 a protocol tests, and the reasons for the others: before the study, in the bundle and on
/// the page.

#include "libstudy/analysis/claims.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/analysis/tasks/results.hpp"
#include "libstudy/preregistration/preregistration.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/report/page.hpp"
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

/// A design that rates realism and strain on 1 to 4.
std::string own_realism() {
  return replaced(replaced(own_design(), "ask comfort strain", "ask realism strain"), "id = \"comfort\"",
                  "id = \"realism\"");
}

/// Pairs, with a choice that has a third answer.
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
  for (const auto& [id, reason] : study::hypotheses_of(study::parse_protocol(text, "a.toml"), {}).left_out)
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

}  // namespace
}  // namespace apps
