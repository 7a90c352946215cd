/// Answers about pairs, described by cell or by order.

#include "libstudy/analysis/tasks/descriptives_json.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/apps/made_task_study.hpp"

namespace apps {
namespace {

/// Six people judge all pairs, each pair in either order by three people. Answer "better" is 1 if HiRes is
/// shown first, else 7. Answer "three" is always 2, "the second one", of three.
study::TaskData rated_pairs() {
  auto pairs = made_study::task2(6);
  pairs.questions.push_back(made_study::scale("better", 1, 7));
  study::Question three = pairs.questions[0];
  three.id = "three";
  three.anchors.emplace_back(3, "no difference");
  pairs.questions.push_back(three);
  for (auto& session : pairs.sessions) {
    for (auto& trial : session.trials) {
      trial.answers.push_back({"better", trial.first.what.method == "HiRes" ? 1 : 7});
      trial.answers.push_back({"three", 2});
    }
  }
  return study::select_task({{pairs}, 0}, {study::TaskKind::Task2, "", {}}).value();
}

TEST(Descriptives, AnAnswerAboutTheOrderOfAPairIsDescribedByOrder) {
  const auto data = rated_pairs();
  for (const study::Json& question : study::descriptives_json(data, {"better", "three"})) {
    std::size_t answers = 0;
    std::set<std::string> names;
    for (const study::Json& cell : question.at("cells")) {
      const std::string shown = cell.at("shown");
      names.insert(shown);
      answers += cell.at("n").get<std::size_t>();
      ASSERT_TRUE(shown.starts_with("first ")) << shown;
      const std::string first = shown.substr(6, shown.find(", then ") - 6);
      if (question.at("question") == "better") {
        EXPECT_EQ(cell.at("mean"), first == "HiRes" ? 1 : 7) << shown;
      }
    }
    EXPECT_EQ(answers, 60u);
    EXPECT_EQ(names.size(), 20u) << "each pair in both orders";
    EXPECT_TRUE(names.contains("first HiRes, then LoRes"));
    EXPECT_TRUE(names.contains("first LoRes, then HiRes"));
  }
}

TEST(Descriptives, AChoiceOfThePairIsOfBothOrders) {
  const auto data = rated_pairs();
  const study::Json list = study::descriptives_json(data, {"preference"});
  std::set<std::string> names;
  for (const study::Json& cell : list.at(0).at("cells")) names.insert(cell.at("shown"));
  EXPECT_EQ(names.size(), 10u);
  EXPECT_TRUE(names.contains("LoRes and HiRes"));
}

}  // namespace
}  // namespace apps
