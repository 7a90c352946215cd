#include "stats/analysis/score_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace stats {

namespace {

int index_of(const std::vector<std::string>& list, const std::string& item) {
  const auto found = std::find(list.begin(), list.end(), item);
  return found == list.end() ? -1 : static_cast<int>(found - list.begin());
}

/// Equal averages of thirds may differ in their last bit, which ranks would see: to the nearest 2^-40.
double on_grid(double value) { return std::ldexp(std::nearbyint(std::ldexp(value, 40)), -40); }

bool inside(int index, std::size_t size) { return index >= 0 && static_cast<std::size_t>(index) < size; }

}  // namespace

ScoreTable::ScoreTable(ScoreScale scale, std::span<const MethodScore> scores, int participants,
                       std::vector<std::string> n_stars, std::vector<std::string> methods)
    : scale_(std::move(scale)),
      participants_(participants),
      n_stars_(std::move(n_stars)),
      methods_(std::move(methods)) {
  const std::size_t columns = n_stars_.size() * methods_.size();
  std::vector<double> sums(columns * static_cast<std::size_t>(participants_));
  std::vector<int> counts(sums.size());
  for (const MethodScore& score : scores) {
    if (!inside(score.participant, static_cast<std::size_t>(participants_)) ||
        !inside(score.n_star, n_stars_.size()) || !inside(score.method, methods_.size()) ||
        std::isinf(score.value))
      throw std::invalid_argument(
          "a score of no participant, n_* or method of the table, or an infinite one");
    if (std::isnan(score.value)) continue;
    const std::size_t column =
        static_cast<std::size_t>(score.n_star) * methods_.size() + static_cast<std::size_t>(score.method);
    const std::size_t at =
        column * static_cast<std::size_t>(participants_) + static_cast<std::size_t>(score.participant);
    sums[at] += score.value;
    ++counts[at];
  }
  values_.assign(sums.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (counts[i] > 0) values_[i] = on_grid(sums[i] / counts[i]);
  }
}

std::span<const double> ScoreTable::column(int n_star, int method) const {
  if (!inside(n_star, n_stars_.size()) || !inside(method, methods_.size()))
    throw std::invalid_argument("no such column");
  const auto n = static_cast<std::size_t>(participants_);
  const std::size_t column =
      static_cast<std::size_t>(n_star) * methods_.size() + static_cast<std::size_t>(method);
  return std::span<const double>(values_).subspan(column * n, n);
}

std::vector<double> ScoreTable::rows(int n_star) const {
  std::vector<double> out;
  for (std::size_t p = 0; p < static_cast<std::size_t>(participants_); ++p) {
    std::vector<double> row;
    for (std::size_t m = 0; m < methods_.size(); ++m) row.push_back(column(n_star, static_cast<int>(m))[p]);
    const bool empty = std::all_of(row.begin(), row.end(), [](double value) { return std::isnan(value); });
    if (!empty) out.insert(out.end(), row.begin(), row.end());
  }
  return out;
}

int ScoreTable::n_star_index(const std::string& n_star) const { return index_of(n_stars_, n_star); }
int ScoreTable::method_index(const std::string& method) const { return index_of(methods_, method); }

}  // namespace stats
