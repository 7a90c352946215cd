#include "stats/ordinal/rows.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "stats/cholesky.hpp"

namespace stats {

namespace {

void require_lengths(std::size_t n, std::span<const Predictor> predictors,
                     std::span<const int> participants) {
  bool equal = participants.empty() || participants.size() == n;
  for (const auto& predictor : predictors) equal &= predictor.values.size() == n;
  if (!equal)
    throw std::invalid_argument(
        "ordinal fit: ratings, predictors and participants differ in length; give each one value for every "
        "row");
}

std::vector<std::size_t> whole_rows(std::span<const double> ratings, std::span<const Predictor> predictors) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < ratings.size(); ++i) {
    bool whole = !std::isnan(ratings[i]);
    for (const auto& predictor : predictors) whole &= !std::isnan(predictor.values[i]);
    if (whole) rows.push_back(i);
  }
  return rows;
}

/// Scales a column to mean 0 and sd 1; returns the reason if that is impossible.
std::string standardise(OrdinalRows& rows, const Predictor& predictor, const std::vector<std::size_t>& kept) {
  std::vector<double> column;
  for (const std::size_t i : kept) column.push_back(predictor.values[i]);
  const auto [low, high] = std::minmax_element(column.begin(), column.end());
  if (!std::isfinite(*low) || !std::isfinite(*high)) return "predictor " + predictor.name + " is infinite";
  if (*low == *high) {
    return "predictor " + predictor.name + " is constant: its effect cannot be separated from the thresholds";
  }
  const double n = static_cast<double>(column.size());
  double mean = 0, squares = 0;
  for (const double v : column) mean += v / n;
  for (double& v : column) v -= mean;
  for (const double v : column) squares += v * v / n;
  const double scale = std::sqrt(squares);
  for (double& v : column) v /= scale;
  rows.x.push_back(std::move(column));
  rows.centre.push_back(mean);
  rows.scale.push_back(scale);
  return "";
}

bool full_rank(const OrdinalRows& rows) {
  const std::size_t k = rows.x.size();
  std::vector<double> gram(k * k);
  for (std::size_t r = 0; r < k; ++r) {
    for (std::size_t c = 0; c < k; ++c) {
      for (std::size_t i = 0; i < rows.n(); ++i) gram[r * k + c] += rows.x[r][i] * rows.x[c][i];
    }
  }
  return k == 0 || Cholesky::of(gram, 1e-10);
}

}  // namespace

std::vector<Predictor> indicators(const std::string& name, std::span<const double> groups, double reference) {
  std::vector<double> numbers;
  for (const double g : groups) {
    if (!std::isnan(g)) numbers.push_back(g);
  }
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  if (!std::binary_search(numbers.begin(), numbers.end(), reference)) {
    throw std::invalid_argument(
        "indicators: no row belongs to the reference group; choose a group that occurs");
  }
  std::vector<Predictor> columns;
  for (const double number : numbers) {
    if (number == reference) continue;
    std::string text = std::to_string(number);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    Predictor column{name + text, {}};
    for (const double g : groups) column.values.push_back(std::isnan(g) ? g : g == number);
    columns.push_back(std::move(column));
  }
  return columns;
}

std::vector<double> OrdinalRows::location(std::span<const double> beta) const {
  std::vector<double> out(n(), 0.0);
  for (std::size_t k = 0; k < x.size(); ++k) {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += beta[k] * x[k][i];
  }
  return out;
}

Result<OrdinalRows> ordinal_rows(std::span<const double> ratings, std::span<const Predictor> predictors,
                                 std::span<const int> participants) {
  require_lengths(ratings.size(), predictors, participants);
  const auto kept = whole_rows(ratings, predictors);
  if (kept.empty()) return Refusal{"no ratings"};
  OrdinalRows rows;
  rows.n_missing = static_cast<int>(ratings.size() - kept.size());
  for (const std::size_t i : kept) rows.levels.push_back(ratings[i]);
  std::sort(rows.levels.begin(), rows.levels.end());
  rows.levels.erase(std::unique(rows.levels.begin(), rows.levels.end()), rows.levels.end());
  if (std::isinf(rows.levels.front()) || std::isinf(rows.levels.back()))
    return Refusal{"a rating is infinite"};
  if (rows.levels.size() < 2) return Refusal{"all ratings are equal: there is no threshold to estimate"};
  std::map<int, int> number;
  for (const std::size_t i : kept) {
    const auto at = std::lower_bound(rows.levels.begin(), rows.levels.end(), ratings[i]);
    rows.category.push_back(static_cast<int>(at - rows.levels.begin()));
    if (participants.empty()) continue;
    rows.participant.push_back(
        number.emplace(participants[i], static_cast<int>(number.size())).first->second);
  }
  rows.participants = static_cast<int>(number.size());
  for (const auto& predictor : predictors) {
    if (const auto reason = standardise(rows, predictor, kept); !reason.empty()) return Refusal{reason};
  }
  if (!full_rank(rows)) return Refusal{"a predictor is a combination of the others"};
  return rows;
}

std::vector<double> marginal_thresholds(std::span<const int> category, int levels, Link link) {
  std::vector<double> counts(static_cast<std::size_t>(levels)), out;
  for (const int c : category) counts[static_cast<std::size_t>(c)] += 1;
  double below = 0;
  for (std::size_t j = 0; j + 1 < counts.size(); ++j) {
    below += counts[j];
    out.push_back(link_quantile(link, below / static_cast<double>(category.size())));
  }
  return out;
}

void set_original_units(OrdinalFit& fit, const OrdinalRows& rows, std::span<const double> parameters,
                        std::span<const double> covariance) {
  // theta_j - sum b_k (x_k - c_k) / s_k = (theta_j + sum b_k c_k / s_k) - sum (b_k / s_k) x_k.
  const auto q = static_cast<std::size_t>(rows.thresholds()), k = rows.x.size(), p = q + k;
  std::vector<double> map(p * p);
  for (std::size_t i = 0; i < q; ++i) {
    map[i * p + i] = 1;
    for (std::size_t c = 0; c < k; ++c) map[i * p + q + c] = rows.centre[c] / rows.scale[c];
  }
  for (std::size_t c = 0; c < k; ++c) map[(q + c) * p + q + c] = 1 / rows.scale[c];
  std::vector<double> half(p * p), all(p);
  fit.covariance.assign(p * p, 0);
  for (std::size_t i = 0; i < p; ++i) {
    for (std::size_t j = 0; j < p; ++j) {
      all[i] += map[i * p + j] * parameters[j];
      for (std::size_t m = 0; m < p; ++m) half[i * p + m] += map[i * p + j] * covariance[j * p + m];
    }
  }
  for (std::size_t i = 0; i < p; ++i) {
    for (std::size_t j = 0; j < p; ++j) {
      for (std::size_t m = 0; m < p; ++m) fit.covariance[i * p + j] += half[i * p + m] * map[j * p + m];
    }
  }
  fit.thresholds.assign(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(q));
  fit.beta.assign(all.begin() + static_cast<std::ptrdiff_t>(q), all.end());
  fit.levels = rows.levels;
  fit.n = static_cast<int>(rows.n());
  fit.n_missing = rows.n_missing;
}

}  // namespace stats
