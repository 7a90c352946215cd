#include "libstudy/analysis/tasks/retest.hpp"

#include <algorithm>
#include <cmath>

#include "stats/inference/t_test.hpp"

namespace study {

namespace {

using Repeats = std::vector<std::array<double, 2>>;

double share_of_equals(const Repeats& repeats) {
  const auto equal =
      std::count_if(repeats.begin(), repeats.end(), [](const auto& one) { return one[0] == one[1]; });
  return static_cast<double>(equal) / static_cast<double>(repeats.size());
}

Json one_question(const std::string& question, const Repeats& repeats) {
  std::vector<double> before, after;
  double sum = 0, distance = 0;
  for (const auto& one : repeats) {
    before.push_back(one[0]);
    after.push_back(one[1]);
    sum += one[1] - one[0];
    distance += std::abs(one[1] - one[0]);
  }
  const auto n = static_cast<double>(repeats.size());
  const auto paired = stats::t_test_paired(before, after);
  return {{"score", question},
          {"pairs", repeats.size()},
          {"mean_difference", sum / n},
          {"mean_absolute_difference", distance / n},
          {"exact", share_of_equals(repeats)},
          {"correlation", paired ? json_number(paired->r) : Json()}};
}

}  // namespace

Json rating_retest_json(const TaskData& data) {
  Json list = Json::array();
  for (const auto& [question, repeats] : data.repeats) list.push_back(one_question(question, repeats));
  return list;
}

Json choice_retest_json(const TaskData& data) {
  const auto found = data.repeats.find(data.question.id);
  if (found == data.repeats.end()) return {};
  return {{"pairs", found->second.size()}, {"same", share_of_equals(found->second)}};
}

}  // namespace study
