#include "stats/analysis/ssq.hpp"

#include <stdexcept>

namespace stats {

namespace {

struct Subscale {
  const char* name;
  int weight;                // in hundredths
  std::array<int, 7> items;  // numbered from 1, as in Kennedy et al. 1993 (ssq.hpp)
};

constexpr std::array subscales{Subscale{"nausea", 954, {1, 6, 7, 8, 9, 15, 16}},
                               Subscale{"oculomotor", 758, {1, 2, 3, 4, 5, 9, 11}},
                               Subscale{"disorientation", 1392, {5, 8, 10, 11, 12, 13, 14}}};
constexpr int total_weight = 374;

void check(const SsqAnswers& answers) {
  for (const std::optional<int>& answer : answers) {
    if (answer && (*answer < 0 || *answer > ssq_item_max))
      throw std::invalid_argument(
          "ssq_sum: an answer lies outside 0 to 3; give 0 (none) to 3 (severe), or leave it empty");
  }
}

std::optional<int> sum_of(const Subscale& subscale, const SsqAnswers& answers) {
  int sum = 0;
  for (const int item : subscale.items) {
    const std::optional<int>& answer = answers[static_cast<std::size_t>(item - 1)];
    if (!answer) return {};
    sum += *answer;
  }
  return sum;
}

const Subscale& subscale_of(SsqScale scale) { return subscales[static_cast<std::size_t>(scale)]; }

int hundredths(SsqScale scale) { return scale == SsqScale::Total ? total_weight : subscale_of(scale).weight; }

}  // namespace

const char* ssq_name(SsqScale scale) { return scale == SsqScale::Total ? "total" : subscale_of(scale).name; }

double ssq_weight(SsqScale scale) { return hundredths(scale) / 100.; }

std::optional<int> ssq_sum(SsqScale scale, const SsqAnswers& answers) {
  check(answers);
  if (scale != SsqScale::Total) return sum_of(subscale_of(scale), answers);
  int total = 0;
  for (const Subscale& subscale : subscales) {
    const std::optional<int> sum = sum_of(subscale, answers);
    if (!sum) return {};
    total += *sum;
  }
  return total;
}

std::optional<double> ssq_score(SsqScale scale, const SsqAnswers& answers) {
  const std::optional<int> sum = ssq_sum(scale, answers);
  if (!sum) return {};
  return *sum * hundredths(scale) / 100.;
}

}  // namespace stats
