#include "stats/adaptive/quest_plus.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

namespace stats {
namespace {

constexpr double equal_entropies = 1e-15;

/// Entropy in nats of weights w whose sum is W: -sum (w/W) ln(w/W); 0 if W is 0.
double entropy_of(std::span<const double> weights, double sum) {
  if (!(sum > 0)) return 0;
  double h = 0;
  for (const double w : weights)
    if (w > 0) h -= w * std::log(w);
  return h / sum + std::log(sum);
}

}  // namespace

QuestPlus::QuestPlus(int stimuli, int outcomes, std::span<const double> prior,
                     const std::function<double(int, int, int)>& likelihood, std::span<const int> interest)
    : stimuli_(stimuli), outcomes_(outcomes), posterior_(prior.begin(), prior.end()) {
  const double sum = std::accumulate(prior.begin(), prior.end(), 0.0);
  const bool valid = std::ranges::all_of(prior, [](double w) { return w >= 0; });
  if (stimuli < 1 || outcomes < 1 || !valid || !(sum > 0 && std::isfinite(sum)))
    throw std::invalid_argument(
        "QuestPlus: no stimulus, no outcome or no usable prior; give at least one of each, and weights of 0 "
        "or more with a finite sum above 0");
  for (double& w : posterior_) w /= sum;
  interest_.assign(interest.begin(), interest.end());
  if (interest_.empty()) {
    interest_.resize(posterior_.size());
    std::iota(interest_.begin(), interest_.end(), 0);
  }
  if (interest_.size() != posterior_.size() || std::ranges::min(interest_) < 0)
    throw std::invalid_argument(
        "QuestPlus: `interest` does not fit `prior`; give one index of 0 or more for each weight, or none");
  cells_ = std::ranges::max(interest_) + 1;
  likelihood_.reserve(static_cast<std::size_t>(stimuli) * static_cast<std::size_t>(outcomes) *
                      posterior_.size());
  for (int s = 0; s < stimuli; ++s)
    for (int o = 0; o < outcomes; ++o)
      for (int p = 0; p < static_cast<int>(posterior_.size()); ++p) {
        const double chance = likelihood(s, p, o);
        if (!(chance >= 0 && chance <= 1))
          throw std::invalid_argument(
              "QuestPlus: `likelihood` returned a value outside [0, 1]; let it return a probability");
        likelihood_.push_back(chance);
      }
}

double QuestPlus::expected_entropy(int stimulus) const {
  double expected = 0;
  std::vector<double> cells(static_cast<std::size_t>(cells_));
  for (int o = 0; o < outcomes_; ++o) {
    std::ranges::fill(cells, 0.0);
    double sum = 0;
    for (std::size_t p = 0; p < posterior_.size(); ++p) {
      const double w = posterior_[p] * chance(stimulus, o, p);
      cells[static_cast<std::size_t>(interest_[p])] += w;
      sum += w;
    }
    expected += sum * entropy_of(cells, sum);
  }
  return expected;
}

int QuestPlus::next(std::span<const int> allowed) const {
  int best = -1;
  double least = 0;
  const int count = allowed.empty() ? stimuli_ : static_cast<int>(allowed.size());
  for (int i = 0; i < count; ++i) {
    const int s = allowed.empty() ? i : allowed[static_cast<std::size_t>(i)];
    const double h = expected_entropy(s);
    if (best < 0 || h < least - equal_entropies) {
      best = s;
      least = h;
    }
  }
  return best;
}

void QuestPlus::update(int stimulus, int outcome) {
  if (stimulus < 0 || stimulus >= stimuli_ || outcome < 0 || outcome >= outcomes_)
    throw std::invalid_argument(
        "QuestPlus::update: the stimulus or the outcome is not in the grid; give indices from 0 to below the "
        "numbers given to the constructor");
  double sum = 0;
  for (std::size_t p = 0; p < posterior_.size(); ++p) sum += posterior_[p] * chance(stimulus, outcome, p);
  if (!(sum > 0)) return;
  for (std::size_t p = 0; p < posterior_.size(); ++p) posterior_[p] *= chance(stimulus, outcome, p) / sum;
}

int QuestPlus::mode() const {
  return static_cast<int>(std::ranges::max_element(posterior_) - posterior_.begin());
}

double QuestPlus::entropy() const {
  std::vector<double> cells(static_cast<std::size_t>(cells_));
  for (std::size_t p = 0; p < posterior_.size(); ++p)
    cells[static_cast<std::size_t>(interest_[p])] += posterior_[p];
  return entropy_of(cells, 1);
}

GridEstimate grid_estimate(std::span<const double> values, std::span<const double> weights,
                           double confidence) {
  if (values.empty() || values.size() != weights.size())
    throw std::invalid_argument(
        "grid_estimate: no value, or not one weight for each value; give lists of one length above 0");
  std::map<double, double> mass;
  for (std::size_t i = 0; i < values.size(); ++i) mass[values[i]] += weights[i];
  std::vector<double> x, w;
  double sum = 0;
  for (const auto& [value, weight] : mass) {
    x.push_back(value);
    w.push_back(weight);
    sum += weight;
  }
  GridEstimate out;
  for (std::size_t i = 0; i < x.size(); ++i) out.mean += x[i] * w[i] / sum;
  for (std::size_t i = 0; i < x.size(); ++i) out.sd += (x[i] - out.mean) * (x[i] - out.mean) * w[i] / sum;
  out.sd = std::sqrt(out.sd);
  // Ends of the ranges that the values represent, half-way between neighbours. The first and the last range
  // extend equally far to both sides of their value.
  std::vector<double> edge(x.size() + 1, x.front());
  for (std::size_t i = 1; i < x.size(); ++i) edge[i] = (x[i - 1] + x[i]) / 2;
  if (x.size() > 1) edge.front() = 2 * x.front() - edge[1];
  edge.back() = x.size() > 1 ? 2 * x.back() - edge[x.size() - 1] : x.back();
  const auto quantile = [&](double p) {
    double below = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double share = w[i] / sum;
      if (below + share >= p && share > 0) return edge[i] + (edge[i + 1] - edge[i]) * (p - below) / share;
      below += share;
    }
    return edge.back();
  };
  out.low = quantile((1 - confidence) / 2);
  out.high = quantile((1 + confidence) / 2);
  return out;
}

}  // namespace stats
