#pragma once
/// The answers of a study with factors, as values by participant and cell.

#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "libstudy/analysis/plan_hypotheses.hpp"
#include "libstudy/analysis/task_data.hpp"
#include "libstudy/design/adaptive_track.hpp"
#include "stats/analysis/declared_test.hpp"

namespace study {

/// An answer to one question.
struct CellAnswer {
  int participant = 0;  ///< index into TaskData::participants
  /// Index into Design::cells. Pairs with a standard: the comparison's cell. Other pairs: the cell with the
  /// lower index.
  int cell = 0;
  std::optional<int> other;  ///< pairs without a standard: the cell with the higher index
  /// Value of the outcome, such as the score, or 1 or 0 for a choice. NaN for a choice among labels if no
  /// score is declared whose share is the outcome.
  double value = 0;
  int score = 0;  ///< the answered score itself
};

/// The analysed answers to the question, in the order of participants, visits and trials. The value is that
/// of value_of(): the score; 1 or 0 for OutcomeValue::Share; for a choice between the intervals 1 if the
/// comparison (without a standard: cell `cell`) was chosen, else 0. `positive`: the score whose share is the
/// outcome; empty: the higher of two scores.
std::vector<CellAnswer> cell_answers(const TaskData& data, const Question& question,
                                     std::optional<int> positive);

/// An adaptive track of the design: the cells that differ only in the procedure's factor.
struct DesignTrack {
  int cell = 0;      ///< the cell of the lowest level that is not the standard
  std::string name;  ///< levels of the other factors; empty if there are none
};
std::vector<DesignTrack> tracks_of(const Design& design);

/// The estimate of one participant's track.
struct PersonTrack {
  int participant = 0;
  std::size_t track = 0;  ///< index into tracks_of()
  TrackEstimate estimate;
};
/// One entry for each participant and track with answers. Empty without a procedure, and for
/// ProcedureKind::Ptpe.
std::vector<PersonTrack> person_tracks(const TaskData& data);

/// The thresholds as values of the cells that stand for their tracks (DesignTrack::cell).
std::vector<CellAnswer> threshold_values(const TaskData& data, std::span<const PersonTrack> tracks);

/// For each participant, the index in cell_groups() of the group whose cells the participant saw; -1: none.
std::vector<int> groups_of_people(const TaskData& data);

/// Values of the two conditions. If the same participants see both conditions, `a` and `b` have one value for
/// each participant whose cells include both. If different participants see them (compares_groups()), `a` has
/// one value for each participant whose cells include the first condition, and `b` for each whose cells
/// include the second.
struct ConditionValues {
  std::vector<stats::ExactMean> a, b;  ///< NaN: an answer about one of the condition's cells is missing
};
/// A value is the mean, over the condition's cells that the participant saw, of the participant's mean in the
/// cell. For a single condition, every value of `b` is the constant `against` (default 0.5).
ConditionValues condition_values(const TaskData& data, const stats::DeclaredHypothesis& hypothesis,
                                 std::span<const CellAnswer> answers);

/// The single answers of the two conditions, for a regression. Its further terms are indicators of the levels
/// of the factors that the conditions do not name.
stats::AnswerRows condition_rows(const TaskData& data, const stats::DeclaredHypothesis& hypothesis,
                                 std::span<const CellAnswer> answers);

}  // namespace study
