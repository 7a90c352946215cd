#include "stats/analysis/score_table.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace stats {

namespace {

int index_of(const std::vector<std::string>& list, const std::string& item) {
  const auto found = std::find(list.begin(), list.end(), item);
  return found == list.end() ? -1 : static_cast<int>(found - list.begin());
}

bool inside(int index, std::size_t size) { return index >= 0 && static_cast<std::size_t>(index) < size; }

}  // namespace

ScoreTable::ScoreTable(ScoreScale scale, std::span<const MethodScore> scores, int participants,
                       std::vector<std::string> n_stars, std::vector<std::string> methods)
    : scale_(std::move(scale)),
      participants_(participants),
      n_stars_(std::move(n_stars)),
      methods_(std::move(methods)) {
  struct Cell {
    double sum = 0;
    int count = 0;
  };
  std::vector<Cell> cells(n_stars_.size() * methods_.size() * static_cast<std::size_t>(participants_));
  planned_.resize(cells.size());
  for (const MethodScore& score : scores) {
    if (!inside(score.participant, static_cast<std::size_t>(participants_)) || std::isinf(score.sum) ||
        score.items != scores.front().items)
      throw std::invalid_argument(
          "ScoreTable: a score has a participant outside the table, another number of items than the first "
          "or an infinite sum; leave it out or mend it");
    const std::size_t at = first_of(score.n_star, score.method) + static_cast<std::size_t>(score.participant);
    planned_[at] = 1;
    if (std::isnan(score.sum)) continue;
    Cell& cell = cells[at];
    cell.sum += score.sum;
    cell.count += score.items;
    answers_.push_back(score);
  }
  for (const Cell& cell : cells) {
    means_.push_back(cell.count > 0 ? ExactMean{cell.sum, cell.count} : ExactMean{});
    values_.push_back(means_.back().value());
  }
}

std::size_t ScoreTable::first_of(int n_star, int method) const {
  if (!inside(n_star, n_stars_.size()) || !inside(method, methods_.size()))
    throw std::invalid_argument(
        "ScoreTable: no such n_* or method; give indices below the sizes of n_stars() and methods()");
  const auto column = static_cast<std::size_t>(n_star) * methods_.size() + static_cast<std::size_t>(method);
  return column * static_cast<std::size_t>(participants_);
}

std::span<const double> ScoreTable::column(int n_star, int method) const {
  return std::span<const double>(values_).subspan(first_of(n_star, method),
                                                  static_cast<std::size_t>(participants_));
}

std::span<const ExactMean> ScoreTable::means(int n_star, int method) const {
  return std::span<const ExactMean>(means_).subspan(first_of(n_star, method),
                                                    static_cast<std::size_t>(participants_));
}

std::span<const char> ScoreTable::planned(int n_star, int method) const {
  return std::span<const char>(planned_).subspan(first_of(n_star, method),
                                                 static_cast<std::size_t>(participants_));
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
