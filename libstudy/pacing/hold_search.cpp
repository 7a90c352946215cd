#include "libstudy/pacing/hold_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace study {

namespace {

/// A list of holds. The hold of a frame is the number of refresh periods for which it is shown. Stored is,
/// for each k, the number of frames held at most k periods, with the sums from which mean() and sd() follow.
class Holds {
 public:
  explicit Holds(const HoldTarget& target)
      : target_(target),
        n_(static_cast<std::int64_t>(target.rates.size())),
        counts_(static_cast<std::size_t>(target.longest - target.shortest + 1), 0) {
    counts_.back() = n_;
    recount();
  }

  /// Number of edges. Edge e (from 0) separates the hold of shortest + e periods from the next longer hold.
  int edges() const { return static_cast<int>(counts_.size()) - 1; }
  std::int64_t total() const { return total_; }
  double rate(int edge) const { return target_.refresh_hz / (target_.shortest + edge); }
  /// Sum over all frames of the squared difference between rate and target rate, (frames/s)^2.
  double distance2() const { return static_cast<double>(distance2_); }

  double mean() const {
    const double n = static_cast<double>(n_);
    return target_.mean_kind == FpsMean::Harmonic ? n * target_.refresh_hz / static_cast<double>(total_)
                                                  : static_cast<double>(sum_) / n;
  }
  double sd() const {
    const long double n = static_cast<long double>(n_);
    return static_cast<double>(std::sqrt(std::max(0.0L, squares_ / n - (sum_ / n) * (sum_ / n))));
  }
  /// Errors of the mean and of the standard deviation beyond their tolerances; `mean_weight` multiplies the
  /// error of the mean.
  double excess(double mean_weight) const {
    return mean_weight * std::max(0.0, std::abs(mean() - target_.mean) - target_.mean_tolerance) +
           std::max(0.0, std::abs(sd() - target_.sd) - target_.sd_tolerance);
  }

  void set(int edge, std::int64_t count) { counts_[static_cast<std::size_t>(edge)] = count; }

  bool can_move(int edge, int by) const {
    const auto at = static_cast<std::size_t>(edge);
    return by > 0 ? counts_[at] < counts_[at + 1] : counts_[at] > (edge ? counts_[at - 1] : 0);
  }

  /// Changes the hold of one frame by a period. For by = 1 it shortens a hold of shortest + edge + 1 periods;
  /// for by = -1 it lengthens a hold of shortest + edge periods.
  void move(int edge, int by) {
    auto& count = counts_[static_cast<std::size_t>(edge)];
    const long double fast = rate(edge), slow = rate(edge + 1);
    const long double x = target_.rates[static_cast<std::size_t>(by > 0 ? count : count - 1)];
    count += by;
    total_ -= by;
    sum_ += by * (fast - slow);
    squares_ += by * (fast * fast - slow * slow);
    distance2_ += by * ((fast - x) * (fast - x) - (slow - x) * (slow - x));
  }

  std::vector<int> list() const {
    std::vector<int> holds;
    holds.reserve(static_cast<std::size_t>(n_));
    for (std::size_t edge = 0; edge < counts_.size(); ++edge)
      holds.resize(static_cast<std::size_t>(counts_[edge]), target_.shortest + static_cast<int>(edge));
    return holds;
  }

  /// Recomputes the sums for mean(). A harmonic mean needs only the total of periods, without a pass over the
  /// frames.
  void recount_for_mean() {
    if (target_.mean_kind == FpsMean::Arithmetic) return recount();
    total_ = 0;
    std::int64_t shorter = 0;
    for (std::size_t edge = 0; edge < counts_.size(); ++edge) {
      total_ += (counts_[edge] - shorter) * (target_.shortest + static_cast<std::int64_t>(edge));
      shorter = counts_[edge];
    }
  }

  void recount() {
    total_ = 0;
    sum_ = squares_ = distance2_ = 0;
    const auto holds = list();
    for (std::size_t i = 0; i < holds.size(); ++i) {
      const long double f = target_.refresh_hz / holds[i];
      total_ += holds[i];
      sum_ += f;
      squares_ += f * f;
      distance2_ += (f - target_.rates[i]) * (f - target_.rates[i]);
    }
  }

 private:
  const HoldTarget& target_;
  std::int64_t n_;
  std::vector<std::int64_t> counts_;
  std::int64_t total_ = 0;
  long double sum_ = 0, squares_ = 0, distance2_ = 0;
};

/// Sets the holds that minimise sum_i (f_i - x_i)^2 + spread sum_i (f_i - m)^2 - 2 price sum_i f_i. f_i: rate
/// of frame i; x_i: its target rate; m: target mean. For a harmonic mean, the last term is + 2 price (total
/// of periods) instead. Of two successive holds, frame i gets the shorter one if x_i is above the threshold
/// between the two. Updates only the sums for mean(); recount() updates all.
void place(Holds& holds, const HoldTarget& target, double spread, double price) {
  std::int64_t last = 0;
  const auto& x = target.rates;
  for (int edge = 0; edge < holds.edges(); ++edge) {
    const double fast = holds.rate(edge), slow = holds.rate(edge + 1);
    const double per_unit = target.mean_kind == FpsMean::Harmonic ? 1 / (fast - slow) : 1;
    const double threshold = 0.5 * (fast + slow) * (1 + spread) - spread * target.mean - price * per_unit;
    const auto above =
        std::partition_point(x.begin(), x.end(), [&](double rate) { return rate > threshold; });
    last = std::max<std::int64_t>(last, above - x.begin());
    holds.set(edge, last);
  }
  holds.recount_for_mean();
}

/// Bisects `price`, the weight of the mean in the sum that place() minimises, 60 times towards the target
/// mean; a higher price shortens holds.
void place_with_mean(Holds& holds, const HoldTarget& target, double spread) {
  double low = -1, high = 1;
  const auto mean_at = [&](double price) {
    place(holds, target, spread, price);
    return holds.mean();
  };
  while (mean_at(low) > target.mean && low > -1e9) low *= 4;
  while (mean_at(high) < target.mean && high < 1e9) high *= 4;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (mean_at(middle) < target.mean ? low : high) = middle;
  }
  place(holds, target, spread, high);
  holds.recount();
}

/// Bisects `spread`, the weight of the squared deviations from the target mean in the sum that place()
/// minimises, up to 40 times, until the standard deviation is within its tolerance of the target.
void place_with_moments(Holds& holds, const HoldTarget& target) {
  const auto sd_at = [&](double log_weight) {
    place_with_mean(holds, target, std::exp(log_weight) - 1);
    return holds.sd();
  };
  if (std::abs(sd_at(0) - target.sd) <= target.sd_tolerance) return;
  double low = -6, high = 6;  // the standard deviation is largest at low
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    const double sd = sd_at(middle);
    if (std::abs(sd - target.sd) <= 0.5 * target.sd_tolerance) return;
    (sd > target.sd ? low : high) = middle;
  }
}

/// Changes the holds of single frames by one period until all holds sum to `total` periods. Each step takes
/// the change that raises distance2(), the squared distance from the target rates, least.
void fix_total(Holds& holds, std::int64_t total) {
  while (holds.total() != total) {
    const int by = holds.total() > total ? 1 : -1;
    int best = -1;
    double best_cost = 0;
    for (int edge = 0; edge < holds.edges(); ++edge) {
      if (!holds.can_move(edge, by)) continue;
      const double before = holds.distance2();
      holds.move(edge, by);
      const double cost = holds.distance2() - before;
      holds.move(edge, -by);
      if (best < 0 || cost < best_cost) best = edge, best_cost = cost;
    }
    if (best < 0) return;
    holds.move(best, by);
  }
}

/// Quality of a list, smaller is better: first the errors of mean and standard deviation beyond their
/// tolerances, that of the mean times mean_weight; then the squared distance from the target rates.
struct Score {
  double mean_weight, excess, distance2;
  Score(const Holds& holds, double weight)
      : mean_weight(weight), excess(holds.excess(weight)), distance2(holds.distance2()) {}
  bool better_than(const Score& other) const {
    if (std::abs(excess - other.excess) > 1e-12) return excess < other.excess;
    return distance2 < other.distance2 - 1e-9;
  }
};

/// Moves single periods from one frame to another where this improves the score; the total is unchanged.
/// Returns true if a period was moved.
bool exchange(Holds& holds, Score& score) {
  bool moved = false;
  for (int up = 0; up < holds.edges(); ++up) {
    for (int down = 0; down < holds.edges(); ++down) {
      if (up == down || !holds.can_move(up, 1)) continue;
      holds.move(up, 1);
      if (holds.can_move(down, -1)) {
        holds.move(down, -1);
        const Score tried(holds, score.mean_weight);
        if (tried.better_than(score)) {
          score = tried;
          moved = true;
          continue;
        }
        holds.move(down, 1);
      }
      holds.move(up, -1);
    }
  }
  return moved;
}

/// Changes the holds of single frames by one period where this improves the score; the total changes. Returns
/// true if a hold was changed.
bool adjust(Holds& holds, Score& score) {
  bool moved = false;
  for (int edge = 0; edge < holds.edges(); ++edge) {
    for (const int by : {-1, 1}) {
      if (!holds.can_move(edge, by)) continue;
      holds.move(edge, by);
      const Score tried(holds, score.mean_weight);
      if (tried.better_than(score)) {
        score = tried;
        moved = true;
      } else {
        holds.move(edge, -by);
      }
    }
  }
  return moved;
}

/// Changes the holds by single periods as long as this improves their Score, in which `mean_weight`
/// multiplies the error of the mean. total > 0: first brings the sum of the holds to `total` periods and then
/// keeps it; 0: any sum.
void descend(Holds& holds, std::int64_t total, double mean_weight = 1) {
  if (total > 0) fix_total(holds, total);
  Score score(holds, mean_weight);
  for (int sweep = 0; sweep < 5000; ++sweep) {
    const bool exchanged = exchange(holds, score);
    const bool adjusted = total == 0 && adjust(holds, score);
    if (!exchanged && !adjusted) break;
  }
}

HoldList result(const Holds& holds, const HoldTarget& target, std::int64_t total) {
  const double n = static_cast<double>(target.rates.size());
  return {holds.list(), holds.mean(), holds.sd(), std::sqrt(std::max(0.0, holds.distance2()) / n),
          total > 0 && holds.total() != total ? HUGE_VAL : holds.excess(1)};
}

/// Calls descend() on every list of two different holds, one at most and one at least as long as the mean
/// hold, because such lists have the extreme standard deviations. Stops at a list with an excess of 0, whose
/// mean and standard deviation are within their tolerances. Returns the list with the least excess of these
/// and of `best`.
HoldList from_pairs(const HoldTarget& target, std::int64_t total, HoldList best) {
  const auto n = static_cast<std::int64_t>(target.rates.size());
  const auto first = static_cast<std::int64_t>(target.shortest);
  for (std::int64_t fast = first; fast * n <= total && best.excess > 0; ++fast) {
    for (std::int64_t slow = fast + 1; slow <= target.longest && best.excess > 0; ++slow) {
      if (slow * n < total) continue;
      const std::int64_t fast_count = n - (total - fast * n) / (slow - fast);
      Holds holds(target);
      for (int edge = 0; edge < holds.edges(); ++edge) {
        const std::int64_t hold = first + edge;
        holds.set(edge, hold < fast ? 0 : hold < slow ? fast_count : n);
      }
      holds.recount();
      descend(holds, total);
      auto found = result(holds, target, total);
      if (found.excess < best.excess) best = std::move(found);
    }
  }
  return best;
}

}  // namespace

HoldList search_holds(const HoldTarget& target, std::int64_t total) {
  Holds holds(target);
  place_with_moments(holds, target);
  Holds strict = holds;
  descend(holds, total);
  auto best = result(holds, target, total);
  if (best.excess == 0) return best;
  if (total > 0) return from_pairs(target, total, std::move(best));
  // If the total is free, the search may stop at a list where every change improves one moment and worsens
  // the other. So the search is repeated with a weight of 1000 for the error of the mean. Of the lists found,
  // the one with the least error of the mean is returned; of several such lists, that with the least excess.
  const auto mean_miss = [&](const HoldList& list) {
    return std::max(0.0, std::abs(list.mean - target.mean) - target.mean_tolerance);
  };
  for (Holds* start : {&holds, &strict}) {
    descend(*start, total, 1000);
    auto found = result(*start, target, total);
    if (std::pair(mean_miss(found), found.excess) < std::pair(mean_miss(best), best.excess))
      best = std::move(found);
  }
  return best;
}

namespace {

/// Calls f(fast rate, slow rate, fraction of frames at the fast rate) for every pair of holds that can have
/// the target mean. Rates in frames/s.
void for_each_pair(const HoldTarget& target, const std::function<void(double, double, double)>& f) {
  const auto value = [&](int hold) {  // the frames' average of this quantity determines the mean rate
    return target.mean_kind == FpsMean::Harmonic ? static_cast<double>(hold) : target.refresh_hz / hold;
  };
  const double wished = target.mean_kind == FpsMean::Harmonic ? target.refresh_hz / target.mean : target.mean;
  const double slack = 1e-12 * wished;
  for (int fast = target.shortest; fast <= target.longest; ++fast) {
    for (int slow = fast; slow <= target.longest; ++slow) {
      const double a = value(fast), b = value(slow);
      if (wished < std::min(a, b) - slack || wished > std::max(a, b) + slack) continue;
      const double weight = a == b ? 1 : std::clamp((wished - b) / (a - b), 0.0, 1.0);
      f(target.refresh_hz / fast, target.refresh_hz / slow, weight);
    }
  }
}

/// Largest mean of (rate - c)^2 over the pairs of for_each_pair(), (frames/s)^2. No list of holds
/// with the target mean has a larger variance, whatever c is.
double largest_square(const HoldTarget& target, double c) {
  double largest = 0;
  for_each_pair(target, [&](double fast, double slow, double weight) {
    largest = std::max(largest, weight * (fast - c) * (fast - c) + (1 - weight) * (slow - c) * (slow - c));
  });
  return largest;
}

}  // namespace

SdBounds sd_bounds(const HoldTarget& target) {
  SdBounds bounds;
  double least = HUGE_VAL;
  for_each_pair(target, [&](double fast, double slow, double weight) {
    least = std::min(least, std::sqrt(weight * (1 - weight)) * (fast - slow));
  });
  if (!std::isfinite(least)) return bounds;
  bounds.low = least;
  // largest_square() is a maximum of parabolas and so convex in c: a ternary search finds its minimum.
  double left = target.refresh_hz / target.longest, right = target.refresh_hz / target.shortest;
  for (int i = 0; i < 100 && right - left > 1e-9 * right; ++i) {
    const double a = left + (right - left) / 3, b = right - (right - left) / 3;
    if (largest_square(target, a) < largest_square(target, b))
      right = b;
    else
      left = a;
  }
  bounds.high = std::sqrt(largest_square(target, 0.5 * (left + right)));
  return bounds;
}

}  // namespace study
