#pragma once
/// Each participant's own threshold curve in a pilot (stats/ptpe/people_fit.hpp), as JSON and as the file
/// that the solver reads.

#include <string>
#include <vector>

#include "libsim/ptpe/ptpe_file.hpp"
#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"
#include "stats/ptpe/people_fit.hpp"
#include "stats/ptpe/pilot_people.hpp"

namespace study {

/// The curves of a pilot's participants. PersonContour::participant is an index into data.participants.
struct PeopleContours {
  TaskData data;  ///< with the analysed ratings after the plan's rule for reverse coders
  stats::PeopleFit fit;
  std::vector<int> reversed;  ///< participants who rated higher frame rates lower
  double confidence = 0.95;

  const std::string& code(const stats::PersonContour& one) const;
  /// True if the population's curve lies outside the frame rates shown at more than half of the
  /// deltas.
  bool out_of_reach() const { return 2 * fit.in_reach.size() < fit.deltas.size(); }
  /// Why this participant has no contour of the person's own, as a phrase; empty: the contour may be used.
  std::string doubt(const stats::PersonContour& one) const;
  /// The participant with this code; null: no analysed answer is by such a participant.
  const stats::PersonContour* find(const std::string& code) const;
};

/// Fits the curves at the score `level` to the harmonic mean of the frame rates. Of the plan's rules only the
/// one for reverse coders applies: the model has a drift and lapses of its own. Refused as
/// stats::fit_people().
stats::Result<PeopleContours> fit_people_contours(TaskData data, double level, double confidence,
                                                  const stats::PilotRules& rules);

/// The document of `vip-stats fit-people --json` (docs/statistics.md): every number that the command prints.
Json people_contours_json(const PeopleContours& contours);

/// One participant's curve as the file of a and b that solver and tolerance read. doubt() must be empty.
sim::PtpeFile person_ptpe_file(const PeopleContours& contours, const stats::PersonContour& one);

}  // namespace study
