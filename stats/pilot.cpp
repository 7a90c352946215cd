#include "stats/pilot.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

namespace stats {

namespace {

std::vector<double> distinct(std::span<const PilotRating> ratings, double PilotRating::*field) {
  std::vector<double> values;
  for (const auto& rating : ratings) values.push_back(rating.*field);
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

std::size_t index_of(const std::vector<double>& axis, double value) {
  return static_cast<std::size_t>(std::lower_bound(axis.begin(), axis.end(), value) - axis.begin());
}

void require_finite(const PilotRating& rating) {
  for (const double value : {rating.mu, rating.delta, rating.realised_mu, rating.realised_mu_arithmetic,
                             rating.realised_delta, rating.score}) {
    if (!std::isfinite(value)) throw std::invalid_argument("a rating holds a number that is not finite");
  }
}

}  // namespace

PilotTable::PilotTable(std::span<const PilotRating> ratings)
    : ratings_(ratings.size()),
      mu_(distinct(ratings, &PilotRating::mu)),
      delta_(distinct(ratings, &PilotRating::delta)) {
  std::map<int, int> index;
  for (const auto& rating : ratings) {
    require_finite(rating);
    index.emplace(rating.participant, 0);
    all_equal_ &= rating.score == ratings.front().score;
  }
  for (auto& [participant, i] : index) i = participants_++;
  entries_.resize(static_cast<std::size_t>(participants_) * mu_.size() * delta_.size());
  for (const auto& rating : ratings) {
    const std::size_t cell = index_of(mu_, rating.mu) * delta_.size() + index_of(delta_, rating.delta);
    auto& e =
        entries_[static_cast<std::size_t>(index[rating.participant]) * mu_.size() * delta_.size() + cell];
    e.n += 1;
    e.score += rating.score;
    e.mu_harmonic += rating.realised_mu;
    e.mu_arithmetic += rating.realised_mu_arithmetic;
    e.delta += rating.realised_delta;
  }
}

const PilotTable::Entry& PilotTable::entry(int participant, std::size_t cell) const {
  return entries_[static_cast<std::size_t>(participant) * mu_.size() * delta_.size() + cell];
}

std::size_t PilotTable::settings() const {
  const auto all = grid(PilotMean::Harmonic);
  return static_cast<std::size_t>(
      std::count_if(all.nodes.begin(), all.nodes.end(), [](const auto& node) { return node.has_value(); }));
}

int PilotTable::incomplete_participants() const {
  const auto all = grid(PilotMean::Harmonic);
  int incomplete = 0;
  for (int p = 0; p < participants_; ++p) {
    bool lacks = false;
    for (std::size_t cell = 0; cell < all.nodes.size(); ++cell) {
      lacks |= all.nodes[cell] && entry(p, cell).n == 0;
    }
    incomplete += lacks;
  }
  return incomplete;
}

bool PilotTable::all_equal() const { return all_equal_; }

ScoreGrid PilotTable::grid(PilotMean mean, std::span<const double> weights) const {
  if (!weights.empty() && weights.size() != static_cast<std::size_t>(participants_)) {
    throw std::invalid_argument("one weight for each participant is needed");
  }
  ScoreGrid grid{mu_, delta_, std::vector<std::optional<GridNode>>(mu_.size() * delta_.size())};
  for (std::size_t cell = 0; cell < grid.nodes.size(); ++cell) {
    double n = 0;
    GridNode sum;
    for (int p = 0; p < participants_; ++p) {
      const auto& e = entry(p, cell);
      const double w = weights.empty() ? 1 : weights[static_cast<std::size_t>(p)];
      if (e.n == 0 || w == 0) continue;
      n += w;
      sum.score += w * e.score / e.n;
      sum.mu += w * (mean == PilotMean::Harmonic ? e.mu_harmonic : e.mu_arithmetic) / e.n;
      sum.delta += w * e.delta / e.n;
    }
    if (n > 0) grid.nodes[cell] = GridNode{sum.score / n, sum.mu / n, sum.delta / n};
  }
  return grid;
}

Result<ExponentialFit> estimate_contour(const ScoreGrid& grid, double level) {
  return fit_contour(column_crossings(grid, level, contour_lines(grid)).points);
}

}  // namespace stats
