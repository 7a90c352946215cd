/// Task 1 with dropout, in the results: planned answers, the people in each comparison of two methods, the
/// mixed model and tipping points.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/analysis/tasks/results.hpp"
#include "libstudy/report/page.hpp"
#include "tests/apps/made_task_study.hpp"

namespace apps {
namespace {

using ::testing::HasSubstr;

/// Every third participant leaves after the seventh trial; all other answers exist.
study::TaskProtocol with_dropout(int participants) {
  auto protocol = made_study::task1(participants);
  for (std::size_t p = 0; p < protocol.sessions.size(); p += 3) {
    auto& session = protocol.sessions[p];
    session.state = "dropped out";
    for (auto& trial : session.trials) {
      if (trial.position < 7) continue;
      for (auto& answer : trial.answers) answer.score.reset();
    }
  }
  return protocol;
}

study::Json results_of(const study::TaskProtocol& protocol,
                       stats::ScoreTests tests = stats::ScoreTests::Paired) {
  auto plan = made_study::quick_plan();
  plan.plan.tests = tests;
  return made_study::results_of({{protocol}, 0}, plan);
}

study::TaskData data_of(const study::TaskProtocol& protocol) {
  return study::select_task({{protocol}, 0}, {study::TaskKind::Task1, "", {}}).value();
}

TEST(MissingAnswers, PlannedTrialsWithoutAnAnswerAreKnown) {
  auto protocol = with_dropout(12);
  protocol.sessions[1].trials[0].excluded = "looked away";
  const auto data = data_of(protocol);
  EXPECT_EQ(data.unanswered.size(), 4u * 3 + 1);
  for (const auto& report : data.unanswered) {
    EXPECT_TRUE(report.answers.empty());
    EXPECT_EQ(report.n_star, report.position / 5);
    EXPECT_EQ(report.method, report.position % 5);
  }
}

TEST(MissingAnswers, PeriodsAreThoseOfThePlanWhateverIsMissing) {
  auto protocol = with_dropout(6);
  for (int position = 0; position < 5; ++position)
    protocol.sessions[1].trials[static_cast<std::size_t>(position)].excluded = "looked away";
  auto second = protocol.sessions[2];
  second.visit = 2;
  protocol.sessions.push_back(second);
  for (const auto& report : data_of(protocol).reports)
    EXPECT_EQ(report.period, 2 * (report.visit - 1) + report.position / 5);
}

TEST(MissingAnswers, PairsThatRestOnDifferentPeopleAreFlagged) {
  const auto json = results_of(with_dropout(12));
  const study::Json& people = json.at("task1").at("people");
  ASSERT_EQ(people.size(), 6u);
  EXPECT_EQ(people[0], (study::Json{{"score", "realism"},
                                    {"n_star", "16k"},
                                    {"planned", 12},
                                    {"any", 12},
                                    {"all", 12},
                                    {"fewest", 12},
                                    {"most", 12},
                                    {"differ", false}}));
  EXPECT_EQ(people[1], (study::Json{{"score", "realism"},
                                    {"n_star", "32k"},
                                    {"planned", 12},
                                    {"any", 12},
                                    {"all", 8},
                                    {"fewest", 8},
                                    {"most", 12},
                                    {"differ", true}}));
}

TEST(MissingAnswers, TheMixedModelTakesAllAnswers) {
  const auto json = results_of(with_dropout(12));
  const study::Json& mixed = json.at("task1").at("mixed");
  ASSERT_EQ(mixed.size(), 3u);
  EXPECT_EQ(mixed[0].at("n"), 12 * 10 - 4 * 3);
  EXPECT_EQ(mixed[0].at("participants"), 12);
  std::vector<std::string> terms;
  for (const auto& term : mixed[0].at("terms")) terms.push_back(term.at("term"));
  EXPECT_THAT(terms, ::testing::ElementsAre("scene jet_impact", "scene faucet"));
  // Two terms are linear combinations of others, because each n_* has a period of its own, and each method is
  // always shown at the same position.
  EXPECT_EQ(mixed[0].at("left_out"), (study::Json{"position", "period 2"}));
  int less = 0;
  for (const auto& one : json.at("task1").at("comparisons")) {
    EXPECT_GT(one.at("mixed").at("se"), 0);
    EXPECT_GE(one.at("mixed").at("p_holm"), one.at("mixed").at("p"));
    less += one.at("mixed").at("df") < 100 ? 1 : 0;
  }
  EXPECT_GT(less, 0);
}

TEST(MissingAnswers, TippingPointsStandBesideEachPair) {
  const auto json = results_of(with_dropout(12));
  int tipped = 0;
  for (const auto& one : json.at("task1").at("comparisons")) {
    const study::Json& tipping = one.at("tipping");
    EXPECT_EQ(tipping.at("planned"), 12);
    EXPECT_EQ(tipping.at("holds"), one.at("p") < 0.05);
    const int missing = tipping.at("a").at("missing").get<int>() + tipping.at("b").at("missing").get<int>();
    EXPECT_EQ(missing > 0, one.at("n") < 12);
    for (const char* side : {"a", "b"}) {
      const study::Json& answers = tipping.at(side);
      if (!answers.at("worse_by").is_number()) continue;
      ++tipped;
      EXPECT_GT(answers.at("worse_by"), 0);
      EXPECT_EQ(answers.at("within_scale"), answers.at("worse_by") <= answers.at("room"));
    }
  }
  EXPECT_GT(tipped, 0);
}

TEST(MissingAnswers, TheTestsOfHypothesesHaveTippingPoints) {
  int missing = 0;
  const auto json = results_of(with_dropout(12));
  for (const auto& hypothesis : json.at("hypotheses")) {
    for (const auto& test : hypothesis.at("tests")) {
      const study::Json& tipping = test.at("tipping");
      EXPECT_EQ(tipping.at("planned"), 12);
      EXPECT_EQ(tipping.at("holds"), test.at("holds"));
      missing += tipping.at("a").at("missing").get<int>() + tipping.at("b").at("missing").get<int>();
    }
  }
  EXPECT_GT(missing, 0);
  const auto points = [](const study::Json& results) {
    const std::string page = study::report::results_page(results);
    return page.find("Tipping points of") != std::string::npos;
  };
  EXPECT_TRUE(points(json));
  EXPECT_FALSE(points(results_of(made_study::task1(12)))) << "nobody lacks an answer";
}

TEST(MissingAnswers, EqualDifferencesHaveNoTippingPointAndSaySo) {
  auto protocol = with_dropout(12);
  for (auto& session : protocol.sessions)
    for (auto& trial : session.trials)
      for (auto& answer : trial.answers)
        if (answer.score) answer.score = trial.position % 3;
  const auto json = results_of(protocol);
  int without = 0;
  for (const auto& one : json.at("task1").at("comparisons")) {
    const study::Json& tipping = one.at("tipping");
    EXPECT_EQ(one.at("test"), "exact sign test");
    EXPECT_EQ(tipping.at("holds"), one.at("p") < 0.05);
    EXPECT_THAT(tipping.at("reason").get<std::string>(), HasSubstr("all differences are equal"));
    EXPECT_TRUE(tipping.at("a").at("worse_by").is_null());
    without += tipping.at("a").at("missing") > 0 ? 1 : 0;
  }
  EXPECT_GT(without, 0);
  EXPECT_THAT(study::report::results_page(json), HasSubstr("unknown, "));
}

// The tests of H1 then equal the mixed model's results in `comparisons`. The key `paired` of each hypothesis
// has the paired tests of the same data.
TEST(MissingAnswers, ThePlanMayDecideByTheMixedModel) {
  const auto json = results_of(with_dropout(12), stats::ScoreTests::Mixed);
  EXPECT_EQ(json.at("plan").at("tests"), "mixed");
  const auto paired = results_of(with_dropout(12));
  EXPECT_EQ(paired.at("plan").at("tests"), "paired");
  int compared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const study::Json& hypothesis = json.at("hypotheses")[i];
    EXPECT_THAT(hypothesis.at("rule").get<std::string>(), HasSubstr("t tests of the mixed model"));
    const study::Json& of_pairs = paired.at("hypotheses")[i];
    EXPECT_EQ(hypothesis.at("paired").at("status"), of_pairs.at("status"));
    EXPECT_FALSE(of_pairs.contains("paired"));
    for (std::size_t k = 0; k < hypothesis.at("tests").size(); ++k) {
      const study::Json& test = hypothesis.at("tests")[k];
      EXPECT_EQ(test.at("method"), "t test of the mixed model");
      EXPECT_EQ(test.at("tipping").at("holds"), test.at("holds"));
      EXPECT_EQ(hypothesis.at("paired").at("tests")[k].at("p"), of_pairs.at("tests")[k].at("p"));
      for (const auto& one : json.at("task1").at("comparisons")) {
        if (hypothesis.at("id") != "H1" || one.at("score") != test.at("score") ||
            one.at("n_star") != test.at("n_star") || one.at("a") != test.at("b") ||
            one.at("b") != test.at("a"))
          continue;
        EXPECT_NEAR(test.at("t"), -one.at("mixed").at("t").get<double>(), 1e-12);
        EXPECT_NEAR(test.at("df"), one.at("mixed").at("df"), 1e-12);
        EXPECT_NEAR(test.at("p"), one.at("mixed").at("p"), 1e-12);
        ++compared;
      }
    }
  }
  EXPECT_EQ(compared, 8);
}

}  // namespace
}  // namespace apps
