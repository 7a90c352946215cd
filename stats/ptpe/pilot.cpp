#include "stats/ptpe/pilot.hpp"

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
    if (!std::isfinite(value))
      throw std::invalid_argument(
          "PilotTable: a rating holds a number that is not finite; leave this rating out");
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
    throw std::invalid_argument(
        "PilotTable::grid: not one weight for each participant; give as many as participants(), or none");
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

std::vector<double> PilotTable::scores(std::size_t node) const {
  std::vector<double> out;
  for (int p = 0; p < participants_; ++p) {
    const auto& e = entry(p, node);
    if (e.n > 0) out.push_back(e.score / e.n);
  }
  return out;
}

std::vector<PilotObservation> PilotTable::observations(PilotMean mean) const {
  std::vector<PilotObservation> out;
  for (int p = 0; p < participants_; ++p) {
    for (std::size_t cell = 0; cell < mu_.size() * delta_.size(); ++cell) {
      const auto& e = entry(p, cell);
      if (e.n == 0) continue;
      const double mu = mean == PilotMean::Harmonic ? e.mu_harmonic : e.mu_arithmetic;
      out.push_back({.participant = p,
                     .mu = mu / e.n,
                     .delta = e.delta / e.n,
                     .score = e.score / e.n,
                     .nominal_delta = delta_[cell % delta_.size()],
                     .nominal_mu = mu_[cell / delta_.size()]});
    }
  }
  return out;
}

Result<ExponentialFit> estimate_contour(const ScoreGrid& grid, double level) {
  return fit_contour(column_crossings(grid, level, contour_lines(grid)).points);
}

Result<PilotSpread> pilot_spread(const ResampledCurves& curves, int participants, double confidence) {
  const int n = participants, resamples = static_cast<int>(curves.size());
  std::vector<double> a, b;
  for (const auto& curve : curves) {
    if (!curve) continue;
    a.push_back((*curve)[0]);
    b.push_back((*curve)[1]);
  }
  const int failed = resamples - static_cast<int>(a.size());
  if (a.size() < 2 || failed > largest_failed_share * resamples) {
    return Refusal{std::to_string(failed) + " of " + std::to_string(resamples) +
                   " resamples of the participants have no fit"};
  }
  const bool extremes = expanded_tail(n, confidence) * static_cast<double>(a.size()) < 1;
  return PilotSpread{.a_ci = expanded_percentile_interval(a, n, confidence),
                     .b_ci = expanded_percentile_interval(b, n, confidence),
                     .a_se = bootstrap_se(a),
                     .b_se = bootstrap_se(b),
                     .resamples = resamples,
                     .failed = failed,
                     .extremes = extremes};
}

namespace {

ResampledCurves resampled_contours(const PilotTable& table, PilotMean mean, double level,
                                   const BootstrapOptions& options, ResampleRange range) {
  ResampledCurves out;
  for (int i = range.first; i < range.first + range.count; ++i) {
    const auto weights = resample_weights(table.participants(), options.seed, static_cast<std::uint64_t>(i));
    const auto fit = estimate_contour(table.grid(mean, weights), level);
    out.emplace_back();
    if (fit) out.back() = std::array{fit->a, fit->b};
    if (options.progress) options.progress(i + 1);
  }
  return out;
}

}  // namespace

ResampledCurves resample_pilot(const PilotTable& table, PilotMean mean, double level,
                               const BootstrapOptions& options, ResampleRange range) {
  if (table.participants() < least_participants || !estimate_contour(table.grid(mean), level)) return {};
  return resampled_contours(table, mean, level, options, range);
}

PilotEstimate estimate_pilot(const PilotTable& table, PilotMean mean, double level,
                             const BootstrapOptions& options, const ResampledCurves* drawn) {
  const int n = table.participants();
  const auto grid = table.grid(mean);
  PilotEstimate estimate;
  estimate.contour = column_crossings(grid, level, contour_lines(grid));
  estimate.fit = fit_contour(estimate.contour.points);
  if (!estimate.fit) {
    estimate.spread = Refusal{estimate.fit.reason()};
  } else if (n < least_participants) {
    estimate.spread = Refusal{"an interval over participants needs at least " +
                              std::to_string(least_participants) + " of them, not " + std::to_string(n)};
  } else if (!drawn) {
    const auto curves = resampled_contours(table, mean, level, options, {0, options.resamples});
    estimate.spread = pilot_spread(curves, n, options.confidence);
  } else if (static_cast<int>(drawn->size()) == options.resamples) {
    estimate.spread = pilot_spread(*drawn, n, options.confidence);
  } else {
    throw std::invalid_argument("estimate_pilot: " + std::to_string(drawn->size()) + " curves for " +
                                std::to_string(options.resamples) + " resamples; give one for each");
  }
  return estimate;
}

}  // namespace stats
