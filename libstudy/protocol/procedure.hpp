#pragma once
/// Adaptive procedures: the stimulus of a trial follows from the answers to earlier trials.

#include <optional>
#include <string>
#include <vector>

#include "libstudy/pacing/profile.hpp"
#include "stats/adaptive/psychometric.hpp"
#include "stats/adaptive/staircase.hpp"

namespace study {

/// The rule that chooses the stimulus of the next trial.
enum class ProcedureKind {
  Staircase,  ///< transformed or weighted up-down rule (Levitt 1971, Kaernbach 1991)
  QuestPlus,  ///< QUEST+ (Watson 2017)
  /// Means and standard deviations of the frame rate near the contour of equal rating that the ratings so far
  /// suggest (stats/ptpe/placement.hpp).
  Ptpe
};

/// A track is the sequence of trials whose cells differ only in the level of `factor`. Each combination of
/// the other within-subject levels has its own track in a session; the tracks are interleaved at random.
struct Procedure {
  ProcedureKind kind = ProcedureKind::Staircase;
  std::size_t factor = 0;  ///< index of a within-subject factor
  std::string question;    ///< id of the question whose answers steer the track
  /// Value of each level on the stimulus axis, ascending, in the unit of the key `axis`. Ptpe: the mean of
  /// the frame rate.
  std::vector<double> values;
  std::string axis;               ///< key of the levels' timing, such as "hitch_ms"; empty for Ptpe
  std::vector<double> deviation;  ///< Ptpe: standard deviation of the frame rate of each level
  int trials = 40;                ///< number of trials of each track
  /// The score that counts as a positive answer; none for pairs and for Ptpe. In pairs, the choice of the
  /// comparison counts as positive if `comparison` is true, and the choice of the standard if it is false.
  std::optional<int> positive;
  bool comparison = true;

  /// Staircase: values are indices of levels, steps are numbers of levels.
  stats::StaircaseRules rules;
  /// QuestPlus: form of the psychometric function, guess rate, and the lapse rates of the grid.
  stats::PsychometricForm form = stats::PsychometricForm::Weibull;
  double guess = 0;
  std::vector<double> lapses{0, 0.02, 0.04};
  /// QuestPlus, Ptpe: a level is chosen at most this often in a track.
  int most_of_one = 1000;
  /// QuestPlus: number of trials at the start of a track, spread evenly over the levels. Ptpe: number of
  /// trials, spread over the session, at the standard deviations between the smallest and the largest in
  /// turn. These trials allow checks of the model.
  int fixed = 0;
};

/// Keys of a timing profile that may be a stimulus axis, such as "hitch_ms".
const std::vector<std::string>& axis_keys();
/// The number of a profile under one of these keys; none: profiles of its kind lack the key.
std::optional<double> axis_value(const TimingProfile& profile, const std::string& key);

/// The word for `kind` in protocol files: "staircase", "quest_plus" or "ptpe".
const char* procedure_word(ProcedureKind kind);

}  // namespace study
