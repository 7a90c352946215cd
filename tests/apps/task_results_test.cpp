/// The results' document, its tables and the analysis plan.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "libstudy/analysis/tasks/csv.hpp"
#include "libstudy/analysis/tasks/results.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/inference/adjust.hpp"
#include "tests/apps/made_task_study.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps {
namespace {

using ::test::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

using made_study::quick_plan;
using made_study::results_of;

const study::Json& whole_study() {
  static const study::Json json = results_of({{made_study::task1(26), made_study::task2(26)}, 1});
  return json;
}

/// Names of all fields, such as "a.b". A list counts as its first element.
void names_of(const study::Json& json, const std::string& prefix, std::set<std::string>& names) {
  if (json.is_array() && !json.empty() && json[0].is_object()) return names_of(json[0], prefix + "[]", names);
  if (!json.is_object()) return;
  for (const auto& [key, value] : json.items()) {
    names.insert(prefix + "." + key);
    names_of(value, prefix + "." + key, names);
  }
}

/// Names of the example's parts that the made study has too, without counts that are keyed by words of the
/// data and without fields that depend on the answers.
std::set<std::string> names_to_compare(const study::Json& json) {
  std::set<std::string> all, out;
  names_of(json, "", all);
  for (const auto& name : all) {
    for (const std::string part : {".study", ".flow", ".task1", ".task2", ".hypotheses", ".sensitivity",
                                   ".plan", ".versions", ".descriptives"}) {
      if (name.starts_with(part)) out.insert(name);
    }
  }
  for (const std::string key : {".gaze.", ".stations.", ".displays.", ".angles.", ".unblinded.", "retest",
                                "status_if_testable", ".flow.pilot"})
    std::erase_if(out, [&](const std::string& name) { return name.find(key) != std::string::npos; });
  return out;
}

// scripts/results_example.sh makes the example again.
TEST(TaskResults, TheExampleHasTheFieldsOfTodaysResults) {
  const std::string text = base::read_file(std::string(VIP_TEST_DIR) + "/apps/results_example.json", 1 << 24);
  EXPECT_EQ(names_to_compare(study::Json::parse(text)), names_to_compare(whole_study()));
}

TEST(TaskResults, NoNumberIsNaNInDisguise) {
  // null is allowed where docs/report.md says so, never for a number of a complete study.
  for (const auto& one : whole_study().at("task1").at("comparisons")) {
    for (const char* field : {"p", "p_holm", "p_bh", "difference", "d_z", "g"})
      EXPECT_TRUE(one.at(field).is_number()) << field;
    EXPECT_TRUE(one.at("welch").at("p").is_number());
    EXPECT_TRUE(one.at("bca").is_array());
  }
  for (const auto& one : whole_study().at("task2").at("pairs")) EXPECT_TRUE(one.at("p").is_number());
}

TEST(TaskResults, FamiliesAndTasksAreComplete) {
  const study::Json& json = whole_study();
  EXPECT_EQ(json.at("schema"), "vip-results/1");
  EXPECT_EQ(json.at("study").at("database"), "study.db");
  EXPECT_EQ(json.at("flow").at("task1").at("withdrawn"), 1);
  EXPECT_EQ(json.at("task1").at("comparisons").size(), 3u * 2 * 10);
  EXPECT_EQ(json.at("task1").at("cells").size(), 3u * 2 * 5);
  EXPECT_EQ(json.at("task1").at("ordinal").size(), 5u * 2);
  EXPECT_EQ(json.at("task2").at("pairs").size(), 10u);
  ASSERT_EQ(json.at("hypotheses").size(), 6u);
  const std::vector<int> families{8, 8, 4, 1, 2, 2};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(json.at("hypotheses")[i].at("id"), "H" + std::to_string(i + 1));
    EXPECT_EQ(json.at("hypotheses")[i].at("family"), families[i]);
  }
}

TEST(TaskResults, ClaimsAreCorrectedOverAllSix) {
  std::vector<double> p, of_six;
  for (const auto& one : whole_study().at("hypotheses")) {
    p.push_back(one.at("p_claim"));
    of_six.push_back(one.at("p_claim_of_six"));
  }
  const auto holm = stats::adjust(p, stats::Adjustment::Holm, 6)->p;
  for (std::size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(of_six[i], holm[i], 1e-15);
}

// The family of an ordinal model's effects is its methods, as the family of pairs is all pairs of one score
// at one n_*. A method without answers still belongs to the family.
TEST(TaskResults, OrdinalEffectsAreCorrectedOverTheMethodsOfTheirModel) {
  auto task = made_study::task1(26);
  for (auto& session : task.sessions)
    std::erase_if(session.trials, [](const auto& trial) { return trial.first.what.method == "LoRes"; });
  for (const auto& [json, effects] :
       {std::pair{whole_study(), std::size_t{4}}, std::pair{results_of({{task}, 0}), std::size_t{3}}}) {
    for (const auto& model : json.at("task1").at("ordinal")) {
      std::vector<double> p, holm, bh;
      for (const auto& effect : model.at("effects")) {
        p.push_back(effect.at("p"));
        holm.push_back(effect.at("p_holm"));
        bh.push_back(effect.at("p_bh"));
      }
      ASSERT_EQ(p.size(), effects);
      EXPECT_EQ(holm, stats::adjust(p, stats::Adjustment::Holm, 4)->p);
      EXPECT_EQ(bh, stats::adjust(p, stats::Adjustment::BenjaminiHochberg, 4)->p);
    }
  }
}

TEST(TaskResults, AWorldWithBetterMethodsIsFound) {
  // Quality differs by 1 to 1.3 points from FovFluid, noise 1: H1 and H5 must be supported, H6 must not.
  const auto& hypotheses = whole_study().at("hypotheses");
  EXPECT_EQ(hypotheses[0].at("status"), "supported") << hypotheses[0].at("status_text");
  EXPECT_EQ(hypotheses[4].at("status"), "supported") << hypotheses[4].at("status_text");
  EXPECT_EQ(hypotheses[5].at("status"), "not supported");
}

TEST(TaskResults, WithoutTrackedGazeTwoHypothesesAreNotTestable) {
  const auto json = results_of({{made_study::task1(12, "none"), made_study::task2(12, "mouse")}, 0});
  for (const std::size_t i : {0u, 4u}) {
    EXPECT_EQ(json.at("hypotheses")[i].at("status"), "not testable");
    EXPECT_TRUE(json.at("hypotheses")[i].contains("status_if_testable"));
  }
  for (const std::size_t i : {1u, 2u, 3u, 5u})
    EXPECT_NE(json.at("hypotheses")[i].at("status"), "not testable");
  EXPECT_EQ(json.at("study").at("tracked_gaze"), false);
}

// A study in which all people agree: exact tests, not "no data".
TEST(TaskResults, UnanimousPeopleAreTestedExactly) {
  auto one = made_study::task1(6), two = made_study::task2(6);
  for (auto& session : one.sessions)
    for (auto& trial : session.trials)
      for (auto& answer : trial.answers) answer.score = trial.first.what.method == "LoRes" ? 1 : 2;
  for (auto& session : two.sessions)
    for (auto& trial : session.trials) trial.answers[0].score = 1 + trial.position % 2;
  const auto json = results_of({{one, two}, 0});
  for (const auto& pair : json.at("task1").at("comparisons")) {
    EXPECT_EQ(pair.at("test"), "exact sign test");
    EXPECT_EQ(pair.at("p"), pair.at("a") == "LoRes" ? 0.03125 : 1);
    EXPECT_TRUE(pair.at("t").is_null());
  }
  for (const auto& hypothesis : json.at("hypotheses"))
    EXPECT_NE(hypothesis.at("status"), "no data") << hypothesis.at("id");
  const auto& shares = json.at("task2").at("interval_bias").at("by_participant");
  EXPECT_EQ(shares.at("test"), "exact sign test");
  EXPECT_EQ(shares.at("p"), 1) << "everybody chose the first interval in half of the pairs";
}

TEST(TaskResults, FewPeopleHaveNoBootstrapAndALevelOfTheirOwn) {
  const auto json = results_of({{made_study::task1(5)}, 0});
  int intervals = 0;
  for (const auto& pair : json.at("task1").at("comparisons")) {
    EXPECT_TRUE(pair.at("bca").is_null());
    EXPECT_THAT(pair.at("bca_reason").dump(), ::testing::AnyOf(HasSubstr("too few"), HasSubstr("equal")));
    if (pair.at("wilcoxon").contains("refused")) continue;  // no non-zero difference
    EXPECT_EQ(pair.at("wilcoxon").at("ci_level"), 0.9375);
    ++intervals;
  }
  EXPECT_GT(intervals, 0);
}

TEST(TaskResults, ErrorsOfTheBradleyTerryModelKnowPeople) {
  const auto& model = whole_study().at("task2").at("bradley_terry");
  EXPECT_EQ(model.at("people").at("errors"), "people");
  EXPECT_EQ(model.at("people").at("people_df"), 25);
  for (const auto& pair : model.at("differences")) EXPECT_NE(pair.at("se"), pair.at("se_independent"));
}

TEST(TaskResults, PartsThatTheStudyLacksAreAbsent) {
  const auto results =
      study::make_results({{made_study::task2(8)}, 0},
                          {"s.db", {study::TaskKind::Task1, study::TaskKind::Task2}, "", quick_plan()});
  EXPECT_FALSE(results.json.contains("task1"));
  EXPECT_TRUE(results.json.contains("task2"));
  ASSERT_EQ(results.missing.size(), 1u);
  EXPECT_THAT(results.missing[0].reason, HasSubstr("no protocol"));
}

// H1 to H3 need the items of cybersickness, and are not tested if effects vary.
TEST(TaskResults, RealismAloneIsEnoughWhereEffectsAreAFactor) {
  auto task = made_study::task1(12);
  std::erase_if(task.questions, [](const auto& question) { return question.id != "realism"; });
  EXPECT_THAT(results_of({{task}, 0}).at("not_analysed").dump(),
              HasSubstr("no question 'disorientation', 'unrealism', 'dizziness' or 'confusion' on a scale"));
  task.effects = {{"none", "no effects"}, {"foam", "keeps foam"}};
  for (std::size_t i = 0; i < task.methods.size(); ++i)
    task.treatments.push_back({"", task.methods[i], "", i % 2 ? "foam" : "none"});
  const auto results = results_of({{task}, 0});
  EXPECT_THAT(results.at("hypotheses"), IsEmpty());
  EXPECT_EQ(results.at("task1").at("factors").at(0).at("factor"), "effects") << results.at("task1");
}

TEST(TaskResults, TwoPeopleAndOneMethodMissingGiveReasonsNotNumbers) {
  auto protocol = made_study::task1(2);
  for (auto& session : protocol.sessions)
    std::erase_if(session.trials, [](const auto& trial) { return trial.position % 5 == 0; });
  const auto json = results_of({{protocol}, 0});
  const auto& first = json.at("task1").at("comparisons")[0];
  EXPECT_TRUE(first.at("p").is_null());
  EXPECT_THAT(first.at("reason").get<std::string>(), Not(IsEmpty()));
  EXPECT_TRUE(json.at("task1").at("omnibus")[0].at("friedman").contains("refused"));
  EXPECT_EQ(json.at("task1").at("cells")[0].at("n"), 0);
}

TEST(TaskCsv, FlattensQuotesAndLeavesMissingEmpty) {
  const auto list = study::Json::parse(R"([
    {"name": "a, b", "p": 0.25, "welch": {"t": 1.5}, "ci": [1, "Inf"], "values": [1, 2, 3], "holds": true},
    {"name": "say \"x\"", "p": null, "welch": {"refused": "no"}, "ci": null, "values": [], "holds": false}])");
  EXPECT_EQ(study::csv_text(list),
            "name,p,welch_t,ci_low,ci_high,holds,welch_refused\r\n"
            "\"a, b\",0.25,1.5,1,Inf,1,\r\n"
            "\"say \"\"x\"\"\",,,,,0,no\r\n");
}

TEST(TaskCsv, EveryNumberIsTheJsons) {
  const TemporaryFolder folder;
  study::write_csv_folder(whole_study(), folder.path(), base::write_file_atomically);
  std::istringstream text(base::read_file(folder / "task2_pairs.csv", 1 << 20));
  std::string header, line;
  std::getline(text, header);
  EXPECT_THAT(header, HasSubstr("a,b,n,participants,k,test,share,p,stars"));
  for (const auto& pair : whole_study().at("task2").at("pairs")) {
    std::getline(text, line);
    EXPECT_THAT(line, HasSubstr("," + pair.at("p").dump() + ","));
    EXPECT_THAT(line, HasSubstr("," + pair.at("clopper_pearson")[0].dump() + "," +
                                pair.at("clopper_pearson")[1].dump()));
  }
  for (const char* file :
       {"task1_participant_means", "task1_cells", "task1_comparisons", "task1_omnibus", "task1_ordinal",
        "task2_choices", "hypotheses", "exclusions", "timing", "sensitivity"})
    EXPECT_TRUE(std::filesystem::exists(folder / (std::string(file) + ".csv"))) << file;
}

TEST(TaskCsv, AnEmptyListOfExclusionsHasItsColumns) {
  const TemporaryFolder folder;
  ASSERT_THAT(whole_study().at("exclusions"), IsEmpty());
  study::write_csv_folder(whole_study(), folder.path(), base::write_file_atomically);
  EXPECT_EQ(base::read_file(folder / "exclusions.csv", 1 << 20),
            "task,participant,visit,position,rule,reason,actor,answers\r\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "task1_retest.csv"));
}

TEST(AnalysisPlan, ReadsBackWhatItWrites) {
  const TemporaryFolder folder;
  stats::AnalysisPlan plan;
  plan.alpha = 0.01;
  plan.margin_sickness = 0.3;
  plan.decision = stats::DecisionRule::Holm;
  plan.directional = stats::Directional::All;
  plan.tests = stats::ScoreTests::Mixed;
  plan.exclusions.timing = stats::TimingRule::Degraded;
  plan.exclusions.straight_lining_answers = 9;
  plan.exclusions.max_repeat_difference.reset();
  plan.exclusions.min_repeat_agreement = 0.6;
  plan.repeated_pairs = stats::RepeatedPairs::Warn;
  plan.seed = 77;
  plan.levels = {{"satisfaction", 4}, {"smoothness", 1.5}};
  plan.pilot = {.exclude_reverse_coders = true, .model_drift = false, .model_lapses = true};
  base::write_file_atomically(folder / "plan.toml", study::format_plan(plan, {std::string(64, '1')}));
  const auto read = study::read_plan(folder / "plan.toml");
  EXPECT_EQ(study::format_plan(read.plan, read.protocols), study::format_plan(plan, {std::string(64, '1')}));
  EXPECT_EQ(read.plan.alpha, 0.01);
  EXPECT_EQ(read.plan.decision, stats::DecisionRule::Holm);
  EXPECT_EQ(read.plan.directional, stats::Directional::All);
  EXPECT_EQ(read.plan.tests, stats::ScoreTests::Mixed);
  EXPECT_EQ(read.plan.exclusions.timing, stats::TimingRule::Degraded);
  EXPECT_FALSE(read.plan.exclusions.max_repeat_difference.has_value());
  EXPECT_EQ(read.plan.repeated_pairs, stats::RepeatedPairs::Warn);
  EXPECT_EQ(read.plan.levels, plan.levels);
  EXPECT_TRUE(read.plan.pilot.exclude_reverse_coders);
  EXPECT_FALSE(read.plan.pilot.model_drift);
  EXPECT_TRUE(read.plan.pilot.model_lapses);
  EXPECT_EQ(read.source, "plan.toml");
  EXPECT_EQ(read.sha256.size(), 64u);
}

stats::AnalysisPlan plan_of(const std::string& text) {
  const TemporaryFolder folder;
  base::write_file_atomically(folder / "plan.toml", text);
  return study::read_plan(folder / "plan.toml").plan;
}

// A plan file that names its protocols is part of a bundle. If it lacks the key of the decision rule, it was
// frozen before this key existed, under Holm.
TEST(AnalysisPlan, AFrozenPlanWithoutADecisionRuleIsOneUnderHolm) {
  const auto fresh = plan_of("format = 1\n");
  EXPECT_EQ(fresh.decision, stats::DecisionRule::IntersectionUnion);
  EXPECT_EQ(fresh.directional, stats::Directional::None);
  EXPECT_EQ(fresh.exclusions.straight_lining_answers, 0);
  const auto frozen =
      plan_of("format = 1\nprotocols = [\"ab\"]\n[exclusions]\nstraight_lining_answers = 8\n");
  EXPECT_EQ(frozen.decision, stats::DecisionRule::Holm);
  EXPECT_EQ(frozen.directional, stats::Directional::Once);
  EXPECT_EQ(frozen.tests, stats::ScoreTests::Paired);
  EXPECT_EQ(frozen.exclusions.straight_lining_answers, 8);
  const auto again = plan_of(study::format_plan(frozen, {}));
  EXPECT_EQ(again.decision, stats::DecisionRule::Holm);
  EXPECT_EQ(again.directional, stats::Directional::Once);
  const auto today = plan_of(study::format_plan({}, {"ab"}));
  EXPECT_EQ(today.decision, stats::DecisionRule::IntersectionUnion);
  EXPECT_EQ(today.directional, stats::Directional::None);
}

TEST(AnalysisPlan, IsPreregisteredForItsProtocolsOnly) {
  study::PlanInForce plan = quick_plan();
  EXPECT_EQ(study::plan_json(plan, {std::string(64, '1')}).at("preregistered"), false);
  plan.protocols = {std::string(64, '1')};
  EXPECT_EQ(study::plan_json(plan, {std::string(64, '1')}).at("preregistered"), true);
  EXPECT_EQ(study::plan_json(plan, {std::string(64, '1'), std::string(64, '2')}).at("preregistered"), false);
}

TEST(AnalysisPlan, MistakesAreNamedWithTheirPlace) {
  const TemporaryFolder folder;
  const auto refuse = [&](const std::string& text, const std::string& what) {
    base::write_file_atomically(folder / "plan.toml", text);
    EXPECT_THAT([&] { study::read_plan(folder / "plan.toml"); },
                ThrowsMessage<base::Error>(testing::AllOf(HasSubstr("plan.toml:"), HasSubstr(what))));
  };
  refuse("format = 1\nalpha = 0.6\n", "alpha");
  refuse("format = 1\nalfa = 0.05\n", "alfa");
  refuse("format = 2\n", "format");
  refuse("format = 1\ndecision = \"bonferroni\"\n", "decision");
  refuse("format = 1\ndirectional = \"H1\"\n", "directional");
  refuse("format = 1\ndirectional = \"yes\"\n", "use true or false, without quotes");
  refuse("format = 1\ndirectional = 1\n", "directional");
  refuse("format = 1\ntests = \"welch\"\n", "tests");
  refuse("format = 1\n[exclusions]\ntiming = \"all\"\n", "timing");
  refuse("format = 1\n[exclusions]\nmin_catch_correct = \"never\"\n", "min_catch_correct");
  refuse("format = 1\n[margins]\nrealism = 0\n", "realism");
}

}  // namespace
}  // namespace apps
