#include "libstudy/light/clock_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace study {

namespace {

constexpr double most_drift = 5e-3,
                 drift_step = 1e-3;  // an Arduino's ceramic resonator is off by up to 0.5 %
constexpr double vote_bin_s = 2e-3, near_s = 8e-3, least_agreeing = 0.6;
constexpr std::size_t voting_onsets = 96, most_anchors = 12, most_candidates = 6;

/// A recorded onset and its edge.
struct OnsetPair {
  double t, s;
  bool rise;
};

/// Fits offset, scale and shift by weighted least squares with Tukey's biweight, from a first mapping.
/// least_spread_s: the pairs are no more exact than this.
ClockMapping robust_line(const std::vector<OnsetPair>& pairs, ClockMapping line,
                         double least_spread_s = 2e-5) {
  const auto falls = static_cast<std::size_t>(
      std::count_if(pairs.begin(), pairs.end(), [](const OnsetPair& pair) { return !pair.rise; }));
  const bool shifts = falls > 0 && falls < pairs.size();
  constexpr double cut = 4.685;
  for (int round = 0; round < 30; ++round) {
    std::vector<double> residuals;
    for (const OnsetPair& pair : pairs) residuals.push_back(pair.s - line.at(pair.t, pair.rise));
    const double middle = light_median(residuals);
    for (double& residual : residuals) residual -= middle;
    const double reach = cut * std::max(least_spread_s, light_spread(residuals));
    // Sums for the columns 1, t and dark, and the residual; t and dark are centred below.
    double w = 0, wt = 0, wf = 0, wr = 0;
    std::vector<double> weights;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const double u = residuals[i] / reach;
      const double weight = std::abs(u) < 1 ? (1 - u * u) * (1 - u * u) : 0;
      weights.push_back(weight);
      w += weight;
      wt += weight * pairs[i].t;
      wf += pairs[i].rise ? 0 : weight;
      wr += weight * residuals[i];
    }
    if (!(w > 0)) return line;
    double tt = 0, tf = 0, ff = 0, tr = 0, fr = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const double t = pairs[i].t - wt / w, f = (pairs[i].rise ? 0 : 1) - wf / w;
      tt += weights[i] * t * t;
      tf += weights[i] * t * f;
      ff += weights[i] * f * f;
      tr += weights[i] * t * residuals[i];
      fr += weights[i] * f * residuals[i];
    }
    double slope = tt > 0 ? tr / tt : 0, shift = 0;
    const double determinant = tt * ff - tf * tf;
    if (shifts && determinant > 1e-9 * tt * ff) {
      slope = (tr * ff - fr * tf) / determinant;
      shift = (fr * tt - tr * tf) / determinant;
    }
    const double change = wr / w + middle - slope * wt / w - shift * wf / w;
    line.offset += change;
    line.scale += slope;
    line.shift += shift;
    const double span = pairs.back().t - pairs.front().t;
    if (std::abs(change) + std::abs(slope * span) + std::abs(shift) < 1e-9) break;
  }
  return line;
}

/// Fits offset and scale to the middles of showings, so that a showing with another lag than most has no say:
/// the median of the slopes between them (Theil and Sen), then robust_line(). spans: of each showing's pairs.
ClockMapping through_showings(const std::vector<OnsetPair>& pairs,
                              const std::vector<std::pair<std::size_t, std::size_t>>& spans,
                              ClockMapping line) {
  constexpr std::size_t least_showings = 4, most_showings = 400;
  std::vector<OnsetPair> middles;
  std::vector<double> errors;  // standard errors of the middles
  const std::size_t step = spans.size() / most_showings + 1;
  for (std::size_t i = 0; i < spans.size(); i += step) {
    std::vector<double> residuals;
    double t = 0;
    for (std::size_t k = spans[i].first; k < spans[i].second; ++k) {
      residuals.push_back(pairs[k].s - line.at(pairs[k].t, pairs[k].rise));
      t += pairs[k].t;
    }
    if (residuals.empty()) continue;
    t /= static_cast<double>(residuals.size());
    middles.push_back({t, line.at(t, true) + trimmed_light_mean(residuals), true});
    const double middle = light_median(residuals);
    for (double& residual : residuals) residual -= middle;
    errors.push_back(light_spread(residuals) / std::sqrt(static_cast<double>(residuals.size())));
  }
  if (middles.size() < least_showings) return line;
  std::vector<double> slopes, offsets;
  for (std::size_t i = 0; i < middles.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      slopes.push_back((middles[i].s - middles[k].s) / (middles[i].t - middles[k].t));
  line.scale = light_median(slopes);
  for (const OnsetPair& middle : middles) offsets.push_back(middle.s - line.scale * middle.t);
  line.offset = light_median(offsets);
  return robust_line(middles, line, std::max(2e-5, light_median(errors)));
}

struct StartCandidate {
  int votes = 0;
  double start_s = 0, scale = 1;  ///< sensor's time of the showing's first onset
};

/// A mapping with the edges of the showings that agree with it.
struct Aligned : ClockAlignment {
  std::vector<OnsetPair> pairs;
};

/// The end of a log. Events end with the last change, and their recording goes on.
double end_of_log(const SensorLog& log) { return log.time_s.back() + (log.events ? 1 : 0); }

class Aligner {
 public:
  Aligner(const SensorLog& log, std::span<const LightEdge> edges, const OnsetTimes& onsets_s)
      : log_(log), end_s_(end_of_log(log)), times_(onsets_s) {
    for (const LightEdge& edge : edges) (edge.rise ? rises_ : falls_).push_back(edge.time_s);
  }

  std::optional<Aligned> align() const {
    std::optional<Aligned> best;
    for (const std::size_t anchor : anchors()) {
      for (const StartCandidate& candidate : candidates(anchor)) {
        Aligned found = extended(anchor, candidate);
        if (best && found.pairs.size() <= best->pairs.size()) continue;
        best = std::move(found);
      }
      if (best && best->agreeing >= std::max<std::int64_t>(2, best->inside * 4 / 5)) break;
    }
    return best;
  }

 private:
  /// The showings that vote for the offset: those with the most uneven intervals, whose onsets fit in one
  /// place only.
  std::vector<std::size_t> anchors() const {
    std::vector<std::pair<double, std::size_t>> uneven;
    for (std::size_t i = 0; i < times_.size(); ++i) {
      double sum = 0, squares = 0;
      const auto& t = times_[i];
      const std::size_t count = std::min(t.size(), voting_onsets);
      for (std::size_t k = 1; k < count; ++k) {
        const double step = t[k] - t[k - 1];
        sum += step;
        squares += step * step;
      }
      const auto n = static_cast<double>(count - 1);
      uneven.emplace_back(-std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n))) * n, i);
    }
    std::sort(uneven.begin(), uneven.end());
    std::vector<std::size_t> out;
    for (const auto& [score, index] : uneven)
      if (out.size() < most_anchors) out.push_back(index);
    return out;
  }

  std::vector<StartCandidate> candidates(std::size_t anchor) const {
    const auto& t = times_[anchor];
    const std::size_t count = std::min(t.size(), voting_onsets);
    const double length_s = (1 + most_drift) * (t[count - 1] - t[0]);
    const auto bins = static_cast<std::size_t>((end_s_ + length_s) / vote_bin_s) + 4;
    std::vector<std::uint16_t> votes(bins);
    std::vector<StartCandidate> all;
    const auto bright = static_cast<int>((count + 1) / 2);
    const int enough = static_cast<int>(std::ceil(least_agreeing * bright));
    for (int step = 0; step <= 2 * static_cast<int>(most_drift / drift_step + 0.5); ++step) {
      const double scale = 1 + drift_step * (step % 2 == 1 ? (step + 1) / 2 : -step / 2);
      std::fill(votes.begin(), votes.end(), 0);
      for (std::size_t k = 0; k < count; k += 2) {
        const double ahead_s = scale * (t[k] - t[0]);
        for (const double s : rises_)
          ++votes[static_cast<std::size_t>((s - ahead_s + length_s) / vote_bin_s) + 1];
      }
      int most = 0;
      for (std::size_t b = 1; b + 1 < bins; ++b) {
        const int sum = votes[b - 1] + votes[b] + votes[b + 1];
        most = std::max(most, sum);
        if (sum < enough) continue;
        const double start_s = vote_bin_s * (static_cast<double>(b) - 0.5) - length_s;
        if (!all.empty() && all.back().scale == scale && start_s - all.back().start_s < 1e-2) {
          if (sum > all.back().votes) all.back() = {sum, start_s, scale};
        } else {
          all.push_back({sum, start_s, scale});
        }
      }
      if (most >= bright - 1) break;
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const StartCandidate& a, const StartCandidate& b) { return a.votes > b.votes; });
    std::vector<StartCandidate> out;
    for (const StartCandidate& one : all) {
      const bool known = std::any_of(out.begin(), out.end(), [&](const StartCandidate& other) {
        return std::abs(one.start_s - other.start_s) < 1e-2;
      });
      if (!known && out.size() < most_candidates) out.push_back(one);
    }
    return out;
  }

  /// Adds the first `count` onsets of a showing that have an edge within near_s of mapping + shift_s.
  void collect(std::size_t showing, const ClockMapping& mapping, double shift_s,
               std::vector<OnsetPair>& pairs,
               std::size_t count = std::numeric_limits<std::size_t>::max()) const {
    const auto& t = times_[showing];
    for (std::size_t k = 0; k < std::min(count, t.size()); ++k) {
      const bool rise = k % 2 == 0;
      const auto& side = rise ? rises_ : falls_;
      const double place_s = mapping.at(t[k], rise) + shift_s;
      auto best = std::lower_bound(side.begin(), side.end(), place_s);
      if (best != side.begin() && (best == side.end() || place_s - *(best - 1) < *best - place_s)) --best;
      if (best != side.end() && std::abs(*best - place_s) <= near_s) pairs.push_back({t[k], *best, rise});
    }
  }

  /// The shift of a showing from the mapping, at most reach_s, for which most onsets have an edge; none if
  /// fewer than least_agreeing have.
  std::optional<double> local_shift(std::size_t showing, const ClockMapping& mapping, double reach_s) const {
    constexpr double bin_s = 5e-4;
    constexpr int window = 3;  // bins on each side
    const auto& t = times_[showing];
    const int half = static_cast<int>(reach_s / bin_s) + 1;
    std::vector<int> votes(static_cast<std::size_t>(2 * half + 1));
    for (std::size_t k = 0; k < t.size(); k += 2) {
      const double place_s = mapping.at(t[k], true);
      for (auto e = std::lower_bound(rises_.begin(), rises_.end(), place_s - reach_s);
           e != rises_.end() && *e <= place_s + reach_s; ++e)
        ++votes[static_cast<std::size_t>(std::lround((*e - place_s) / bin_s) + half)];
    }
    double best = 0, best_shift_s = 0;
    int best_sum = 0;
    for (int b = -half; b <= half; ++b) {
      int sum = 0;
      for (int i = std::max(-half, b - window); i <= std::min(half, b + window); ++i)
        sum += votes[static_cast<std::size_t>(i + half)];
      const double score = sum * (1 - 5 * std::abs(b * bin_s));  // of equal places the nearest
      if (score <= best) continue;
      best = score;
      best_sum = sum;
      best_shift_s = b * bin_s;
    }
    if (best_sum < least_agreeing * static_cast<double>((t.size() + 1) / 2)) return {};
    return best_shift_s;
  }

  Aligned extended(std::size_t anchor, const StartCandidate& candidate) const {
    Aligned out;
    const double start_t = times_[anchor].front();
    out.mapping = {candidate.start_s - candidate.scale * start_t, candidate.scale, 0};
    // The drift of a candidate is coarse: refine it on ever more onsets.
    for (std::size_t count = voting_onsets / 2; count < 2 * times_[anchor].size(); count *= 2) {
      std::vector<OnsetPair> pairs;
      collect(anchor, out.mapping, 0, pairs, count);
      if (!pairs.empty()) out.mapping = robust_line(pairs, out.mapping);
    }
    std::vector<std::size_t> order(times_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return std::abs(times_[a].front() - start_t) < std::abs(times_[b].front() - start_t);
    });
    Doubt doubt;
    std::vector<std::pair<std::size_t, std::size_t>> spans;  // of the pairs of each showing
    for (const std::size_t showing : order) {
      const double reach_s = 4e-3 + near_s + doubt.at(times_[showing].front());
      const auto [from_s, to_s] = span_of_showing(times_[showing], out.mapping);
      if (from_s < log_.time_s.front() - reach_s || to_s > end_s_ + reach_s) continue;
      const auto shift_s = local_shift(showing, out.mapping, reach_s);
      if (!shift_s) continue;
      const std::size_t before = out.pairs.size();
      collect(showing, out.mapping, *shift_s, out.pairs);
      spans.emplace_back(before, out.pairs.size());
      ++out.agreeing;
      const bool refit = out.agreeing < 8 || (out.agreeing & (out.agreeing - 1)) == 0;
      if (!refit) continue;
      out.mapping = robust_line(out.pairs, out.mapping);
      doubt = doubt_of(out);
    }
    if (!out.pairs.empty()) out.mapping = robust_line(out.pairs, out.mapping);
    out.mapping = through_showings(out.pairs, spans, out.mapping);
    for (std::size_t i = 0; i < times_.size(); ++i)
      out.inside += why_unjudged(times_[i], out.mapping, log_).empty();
    return out;
  }

  /// How far a mapping may be off, s: nothing at the mean time of its pairs, and more away from it.
  struct Doubt {
    double mean_t = 0, per_s = 0;
    double at(double t) const { return per_s * std::abs(t - mean_t); }
  };

  static Doubt doubt_of(const Aligned& so_far) {
    std::vector<double> residuals;
    double mean = 0, squares = 0;
    for (const OnsetPair& pair : so_far.pairs) {
      residuals.push_back(pair.s - so_far.mapping.at(pair.t, pair.rise));
      mean += pair.t / static_cast<double>(so_far.pairs.size());
    }
    for (const OnsetPair& pair : so_far.pairs) squares += (pair.t - mean) * (pair.t - mean);
    constexpr double least_s = 3e-4, times = 5;
    if (!(squares > 0)) return {};
    return {mean, times * std::max(least_s, light_spread(residuals)) / std::sqrt(squares)};
  }

  const SensorLog& log_;
  double end_s_;
  std::vector<double> rises_, falls_;
  const OnsetTimes& times_;
};

}  // namespace

std::optional<ClockAlignment> align_clocks(const SensorLog& log, std::span<const LightEdge> edges,
                                           const OnsetTimes& onsets_s) {
  const auto found = Aligner(log, edges, onsets_s).align();
  if (!found || found->agreeing == 0) return {};
  return *found;
}

std::pair<double, double> span_of_showing(const std::vector<double>& onsets_s, const ClockMapping& mapping) {
  const auto& t = onsets_s;
  return {mapping.at(t.front(), true) - 0.5 * (t[1] - t[0]),
          mapping.at(t.back(), true) + (t.back() - t[t.size() - 2])};
}

std::string why_unjudged(const std::vector<double>& onsets_s, const ClockMapping& mapping,
                         const SensorLog& log) {
  const auto [from_s, to_s] = span_of_showing(onsets_s, mapping);
  if (to_s < log.time_s.front() || from_s > end_of_log(log)) return "is not in the log";
  if (from_s < log.time_s.front()) return "began before the log";
  if (to_s > end_of_log(log)) return "went on after the log";
  for (const SensorLog::Gap& gap : log.gaps)
    if (gap.to_s > from_s && gap.from_s < to_s)
      return fmt::format("the log has a gap of {:.3g} ms in it", 1e3 * (gap.to_s - gap.from_s));
  return "";
}

double light_median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

/// Median absolute value, scaled to the standard deviation of a normal distribution.
double light_spread(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  return 1.4826 * light_median(std::move(values));
}

double trimmed_light_mean(const std::vector<double>& residuals) {
  const double middle = light_median(residuals);
  std::vector<double> away = residuals;
  for (double& one : away) one -= middle;
  const double reach = 4 * std::max(1e-6, light_spread(away));
  double sum = 0;
  int count = 0;
  for (const double one : away) {
    if (std::abs(one) > reach) continue;
    sum += one;
    ++count;
  }
  return middle + (count > 0 ? sum / count : 0);
}

}  // namespace study
