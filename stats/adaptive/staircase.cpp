#include "stats/adaptive/staircase.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stats {
namespace {

void require_valid(const StaircaseRules& r) {
  const bool steps = !r.steps.empty() && std::ranges::all_of(r.steps, [](double s) { return s > 0; });
  if (!(r.lowest <= r.start && r.start <= r.highest) || !steps || r.down_after < 1 || r.up_after < 1 ||
      !(r.up_ratio > 0) || r.trials < 0 || r.reversals < 0 || (r.decibels && !(r.lowest > 0)))
    throw std::invalid_argument(
        "replay_staircase: a rule is out of range; set lowest <= start <= highest (lowest above 0 with "
        "decibels), steps and up_ratio above 0, down_after and up_after from 1, trials and reversals from 0");
}

}  // namespace

std::optional<double> target_share(const StaircaseRules& rules) {
  if (rules.up_ratio == 1 && rules.up_after == 1) return std::pow(0.5, 1.0 / rules.down_after);
  if (rules.down_after == 1 && rules.up_after == 1) return rules.up_ratio / (1 + rules.up_ratio);
  return std::nullopt;
}

StaircaseTrack replay_staircase(const StaircaseRules& rules, std::span<const bool> positive) {
  require_valid(rules);
  StaircaseTrack track;
  double stimulus = rules.start;
  track.stimuli.push_back(stimulus);
  int in_a_row = 0;   // above 0: positive responses since the last step, below 0: negative ones
  int direction = 0;  // of the last step: -1 down, 1 up
  for (std::size_t i = 0; i < positive.size() && !track.ended; ++i) {
    in_a_row = positive[i] ? std::max(in_a_row, 0) + 1 : std::min(in_a_row, 0) - 1;
    const bool single = rules.fast_start && track.reversals.empty();
    const int step = in_a_row >= (single ? 1 : rules.down_after)  ? -1
                     : -in_a_row >= (single ? 1 : rules.up_after) ? 1
                                                                  : 0;
    if (step != 0) {
      in_a_row = 0;
      if (direction != 0 && step != direction) track.reversals.push_back(static_cast<int>(i));
      direction = step;
      const std::size_t at = std::min(track.reversals.size(), rules.steps.size() - 1);
      const double size = rules.steps[at] * (step > 0 ? rules.up_ratio : 1);
      stimulus = rules.decibels ? stimulus * std::pow(10, step * size / 20) : stimulus + step * size;
      stimulus = std::clamp(stimulus, rules.lowest, rules.highest);
    }
    const int count = static_cast<int>(i) + 1;
    const bool bounded = rules.trials > 0 || rules.reversals > 0;
    track.ended =
        bounded && count >= rules.trials && static_cast<int>(track.reversals.size()) >= rules.reversals;
    if (!track.ended) track.stimuli.push_back(stimulus);
  }
  return track;
}

std::optional<double> reversal_mean(const StaircaseRules& rules, const StaircaseTrack& track, int skip) {
  const int count = static_cast<int>(track.reversals.size()) - std::max(skip, 0);
  const int used = count - count % 2;
  if (used < 2) return std::nullopt;
  double sum = 0;
  for (int i = 0; i < used; ++i) {
    const int at = track.reversals[track.reversals.size() - 1 - static_cast<std::size_t>(i)];
    const double x = track.stimuli[static_cast<std::size_t>(at)];
    sum += rules.decibels ? std::log(x) : x;
  }
  return rules.decibels ? std::exp(sum / used) : sum / used;
}

}  // namespace stats
