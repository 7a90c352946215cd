#include "stats/preference/trials.hpp"

#include <cmath>
#include <stdexcept>

namespace stats {

void check_trials(std::span<const Comparison> trials, int items) {
  const auto outside = [items](int item) { return item < 0 || item >= items; };
  for (const auto& t : trials) {
    if (outside(t.first) || outside(t.second) || t.first == t.second || !std::isfinite(t.position))
      throw std::invalid_argument("a comparison of items outside the list, or without a position");
  }
}

std::vector<double> win_table(std::span<const Comparison> trials, int items) {
  const auto n = static_cast<std::size_t>(items);
  std::vector<double> wins(n * n, 0.0);
  for (const auto& t : trials) {
    const int winner = t.first_chosen ? t.first : t.second, loser = t.first_chosen ? t.second : t.first;
    wins[static_cast<std::size_t>(winner) * n + static_cast<std::size_t>(loser)] += 1;
  }
  return wins;
}

std::vector<LogitRow> trial_rows(std::span<const Comparison> trials, int items, std::size_t terms) {
  std::vector<LogitRow> rows;
  for (const auto& t : trials) {
    LogitRow row{std::vector<double>(static_cast<std::size_t>(items - 1) + terms, 0.0),
                 t.first_chosen ? 1.0 : 0.0, 1};
    if (t.first > 0) row.design[static_cast<std::size_t>(t.first - 1)] = 1;
    if (t.second > 0) row.design[static_cast<std::size_t>(t.second - 1)] = -1;
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace stats
