/// [[hypothesis]] in a plan file: what is read, what is refused, and that it is frozen.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/analysis/plan_file.hpp"
#include "libstudy/preregistration/preregistration.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps::test {
namespace {

using ::testing::HasSubstr;
using namespace ::test;

study::Protocol shipped(const std::string& name) {
  return study::read_protocol(base::resource("protocols/" + name + ".toml"));
}

const std::string planted = R"(
[[hypothesis]]
id = "seen"
text = "A hitch of 50 ms is seen more often than none."
outcome = "stall"
compare = [{hitch = "h50"}, {hitch = "none"}]
test = "paired_t"
alternative = "greater"
family = "hitches"
)";

stats::AnalysisPlan plan_of(const std::string& tables, const study::Protocol* protocol) {
  const TemporaryFolder folder;
  base::write_file_atomically(folder / "plan.toml", "format = 1\n" + tables);
  return study::read_plan(folder / "plan.toml", protocol).plan;
}

std::string refused(std::string tables, const std::string& from, const std::string& to,
                    const study::Protocol& protocol) {
  const auto at = tables.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  try {
    plan_of(tables.replace(at, from.size(), to), &protocol);
  } catch (const base::Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(DeclaredHypotheses, AreReadAndWrittenWhole) {
  const auto protocol = shipped("hitches");
  const auto plan = plan_of(planted + R"(
[[hypothesis]]
id = "content"
outcome = "stall"
positive = 0
compare = [{content = "dam", hitch = "h50"}, {content = "drop", hitch = "h50"}]
test = "welch_t"
alternative = "less"
margin = 0.1
confidence = 0.9
family = "hitches"
adjust = "holm"

[[hypothesis]]
id = "chance"
outcome = "stall"
compare = [{hitch = "h33"}]
against = 0.5
test = "tost"
margin = 0.25
)",
                            &protocol);
  ASSERT_EQ(plan.hypotheses.size(), 3u);
  const auto& seen = plan.hypotheses[0];
  EXPECT_EQ(seen.compare[0].at("hitch"), "h50");
  EXPECT_EQ(seen.test.alternative, stats::Alternative::Greater);
  EXPECT_EQ(seen.adjust, stats::Adjustment::Holm) << "the default in a family";
  EXPECT_EQ(seen.test.confidence, 0.95);
  EXPECT_EQ(plan.hypotheses[2].adjust, stats::Adjustment::None);
  const auto text = study::format_plan(plan, {"ab"});
  const TemporaryFolder folder;
  base::write_file_atomically(folder / "again.toml", text);
  const auto again = study::read_plan(folder / "again.toml", &protocol);
  EXPECT_EQ(study::format_plan(again.plan, {"ab"}), text);
  EXPECT_EQ(study::plan_json(again, {}).at("hypotheses").size(), 3u);
}

TEST(DeclaredHypotheses, WhatDoesNotFitTheProtocolIsRefusedAtItsPlace) {
  const auto protocol = shipped("hitches");
  const auto expect = [&](const char* from, const char* to, const char* words) {
    EXPECT_THAT(refused(planted, from, to, protocol), HasSubstr(words)) << to;
  };
  expect("h50", "h5", "plan.toml:7:");
  expect("h50", "h5", "use one of \"none\", \"h33\", \"h50\"");
  expect("\"stall\"", "\"stalls\"", "the nearest is \"stall\"");
  expect("hitch = \"h50\"}, {hitch", "hich = \"h50\"}, {hich", "is no factor of the protocol");
  expect("\"stall\"", "\"stal\"", "is not the id of a question with scores");
  expect("hitch = \"none\"", "hitch = \"h50\"", "is the same as the first table");
  expect("paired_t", "anova", "is not a known choice");
  expect("paired_t", "welch_t", "each participant sees both conditions");
  expect("paired_t", "mixed", "\"clmm\"");
  expect(", {hitch = \"none\"}", "", "write against");
  expect("family", "margn = 1\nfamily", "margn");
  expect("family = \"hitches\"", "adjust = \"holm\"", "needs a family");
  expect("\"greater\"", "\"two-sided\"\nmargin = 1", "needs a side");
  expect("\"greater\"", "\"greater\"\nmargin = 1", "every difference is within it");
  expect(", {hitch = \"none\"}]", "]\nagainst = 7", "is no value of the outcome");
  expect("{hitch = \"h50\"}, {hitch = \"none\"}", "{content = \"dam\"}, {content = \"drop\"}",
         "different people see the two conditions");
  expect("hitch = \"none\"}", "content = \"dam\"}", "names other factors");
  EXPECT_THAT(refused(planted + planted, "x", "x", protocol), HasSubstr("is the id of another hypothesis"));
  // Without a protocol, names of factors and levels are not checked.
  EXPECT_EQ(plan_of(planted, nullptr).hypotheses.size(), 1u);
}

TEST(DeclaredHypotheses, PairsAndProceduresHaveOutcomesOfTheirOwn) {
  const auto pairs = shipped("trace_smoothed");
  std::string question;
  for (const auto& [block, one] : study::all_questions(pairs))
    if (one->id != "take_part") question = one->id;
  const std::string chosen = "[[hypothesis]]\nid = \"a\"\noutcome = \"" + question +
                             "\"\ncompare = [{frames = \"captured\"}]\ntest = \"wilcoxon\"\n";
  EXPECT_EQ(plan_of(chosen, &pairs).hypotheses.size(), 1u) << "one half is the chance of a pair";
  EXPECT_THAT(refused(chosen, "captured", "even", pairs), HasSubstr("and not those of the standard"));

  const auto quest = shipped("hitch_quest");
  const std::string threshold =
      "[[hypothesis]]\nid = \"a\"\noutcome = \"threshold\"\ncompare = [{}]\n"
      "against = 100\ntest = \"paired_t\"\n";
  EXPECT_EQ(plan_of(threshold, &quest).hypotheses.size(), 1u);
  EXPECT_THAT(refused(threshold, "\"threshold\"", "\"stall\"", quest), HasSubstr("steers the procedure"));
  EXPECT_THAT(refused(threshold, "{}", "{hitch = \"h50\"}", quest), HasSubstr("of the procedure"));
}

TEST(DeclaredHypotheses, AreFrozenByThePreregistration) {
  const TemporaryFolder folder;
  const auto protocol = shipped("hitches");
  study::report::BundleRequest request;
  request.protocols = {base::resource("protocols/hitches.toml")};
  request.plan = plan_of(planted, &protocol);
  study::report::freeze_bundle(request, folder / "bundle");
  const auto bundle = study::report::read_bundle(folder / "bundle");
  ASSERT_EQ(bundle.plan.plan.hypotheses.size(), 1u);
  EXPECT_EQ(bundle.plan.plan.hypotheses[0].id, "seen");
  EXPECT_THAT(
      base::read_file(folder / "bundle" / "PREREGISTRATION.txt", 1 << 20),
      HasSubstr("- seen: stall, hitch h50 against hitch none, paired t test, greater, adjusted (holm)"));
}

}  // namespace
}  // namespace apps::test
