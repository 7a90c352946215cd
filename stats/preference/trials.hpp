#pragma once
/// Single trials of paired comparisons as rows of a logistic regression.

#include <span>
#include <vector>

#include "stats/preference/logit_fit.hpp"

namespace stats {

/// One 2AFC trial.
struct Comparison {
  int first = 0, second = 0;  ///< items shown in the first and the second interval, from 0
  bool first_chosen = false;
  double position = 0;  ///< position of the trial in its session, 1, 2, 3 ...; any unit
  int participant = 0;  ///< any number; equal numbers are one participant
};

/// std::invalid_argument for an item outside [0, items), equal items, or a position that is not finite.
void check_trials(std::span<const Comparison> trials, int items);

/// Counts of wins: items by items, row after row, as bradley_terry() takes them.
std::vector<double> win_table(std::span<const Comparison> trials, int items);

/// One row for each trial: the strengths of all items but the first, then `terms` columns of zeros for
/// further terms.
std::vector<LogitRow> trial_rows(std::span<const Comparison> trials, int items, std::size_t terms = 0);

}  // namespace stats
