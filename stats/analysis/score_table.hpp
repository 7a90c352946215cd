#pragma once
/// Scores of Task 1 (ratings) with one value for each participant, n_* (nominal number of particles) and
/// method. A participant's scenes are averaged first, because pooling dependent answers as if independent
/// gives false alarms.

#include <span>
#include <string>
#include <vector>

#include "stats/inference/exact_mean.hpp"

namespace stats {

/// A participant's answers after one trial. Indices count from 0. The score is the mean of `items` answers.
struct MethodScore {
  int participant = 0, scene = 0, n_star = 0, method = 0;
  double sum = 0;  ///< sum of the answers; NaN: the report was planned, but an answer is missing
  int items = 1;
  int position = 0;  ///< position of the trial in its visit
  int period = 0;    ///< period of the session; see periods_of() in mixed_scores.hpp

  double value() const { return sum / items; }
};

/// A score: its name, scale, direction and margin.
struct ScoreScale {
  std::string code;   ///< "realism", "sickness", ...
  std::string label;  ///< name for display
  bool primary = true;
  double min = 1, max = 7;
  bool higher_is_better = true;
  std::vector<std::string> items;  ///< ids of the questions whose mean is the score
  double margin = 0.5;             ///< margin of equivalence and non-inferiority, in points of the score
};

/// One mean for each participant, n_* (nominal number of particles) and method.
class ScoreTable {
 public:
  /// Averages over scenes (and visits) within participant x n_* x method. std::invalid_argument for an index
  /// out of range, an infinite value, or reports of different numbers of items.
  ScoreTable(ScoreScale scale, std::span<const MethodScore> scores, int participants,
             std::vector<std::string> n_stars, std::vector<std::string> methods);

  const ScoreScale& scale() const { return scale_; }
  int participants() const { return participants_; }
  const std::vector<std::string>& n_stars() const { return n_stars_; }
  const std::vector<std::string>& methods() const { return methods_; }
  /// Mean score of each participant; NaN if missing.
  std::span<const double> column(int n_star, int method) const;
  /// The same means as sums and counts, for code that must find equal differences of means.
  std::span<const ExactMean> means(int n_star, int method) const;
  /// Participants by methods, row after row, of all participants with an answer at this n_* (nominal number
  /// of particles); NaN = missing.
  std::vector<double> rows(int n_star) const;
  /// Nonzero for each participant who was planned to judge this method, answered or not.
  std::span<const char> planned(int n_star, int method) const;
  /// Single reports, without those that lack an answer.
  const std::vector<MethodScore>& answers() const { return answers_; }
  /// Index of an n_* or a method by its name; -1 if there is none.
  int n_star_index(const std::string& n_star) const;
  int method_index(const std::string& method) const;

 private:
  ScoreScale scale_;
  int participants_;
  std::vector<std::string> n_stars_, methods_;
  std::size_t first_of(int n_star, int method) const;

  std::vector<ExactMean> means_;  ///< [n_star][method][participant]
  std::vector<double> values_;    ///< the values of means_ as doubles
  std::vector<char> planned_;     ///< indexed as means_
  std::vector<MethodScore> answers_;
};

}  // namespace stats
