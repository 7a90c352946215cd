#pragma once
/// Simulated answers to what was planned.

#include <cstdint>
#include <span>
#include <vector>

#include "apps/stats/power/worlds.hpp"
#include "stats/analysis/score_table.hpp"
#include "stats/analysis/task2.hpp"
#include "stats/ptpe/pilot.hpp"

namespace apps {

/// How Task 1's answers scatter. Of the latent answers, in points; participants' own level cancels in pairs.
struct Task1Scatter {
  static constexpr double participant_share = 0.6;  ///< SD of participants' levels / SD of the differences
  AnswerScale answers = AnswerScale::Likert;
  double participant_realism = 0, participant_sickness = 0;
  double method_realism = 0, method_sickness = 0;  ///< of person by method, the same at every n_*
  double noise_realism = 0;
  double noise_sickness = 0;  ///< common to the four items of a report
  double noise_item = 0;
  double realism_min = 1, realism_max = 7, item_min = 0, item_max = 3;
};

/// Such that the difference between two methods' answers has the standard deviation asked for away from the
/// ends of the scale; the rounding's own variance, 1/12 an answer (Sheppard), is part of it. base::Error when
/// it is less than rounding alone makes.
Task1Scatter task1_scatter(const PowerRequest& request);

struct Task1Answers {
  std::vector<stats::MethodScore> realism, sickness;  ///< by participant
};

/// Answers depend on the key and on each trial, not on how many others there are.
Task1Answers answer_task1(std::span<const ShownTrial> trials, const ShownFactors& factors,
                          const Scenario& truth, const Task1Scatter& scatter, std::uint64_t key);

std::vector<stats::PairChoice> answer_task2(std::span<const ShownTrial> trials, const ShownFactors& factors,
                                            const Scenario& truth, double interval_bias, std::uint64_t key);

/// What a setting's frames really are.
struct RealisedSetting {
  double mu = 0, delta = 0;  ///< nominal
  double harmonic = 0, arithmetic = 0, sd = 0;
};

/// Each cell's schedule compiled once: its moments do not depend on its order.
std::vector<RealisedSetting> realised_settings(const study::Protocol& protocol);

/// Scores that may be given, and the one whose mean the observer's curve is the contour of.
struct RatedScale {
  int min = 1, max = 7;
  double level = 4;
};

/// Ratings by the parametric observer (libstudy/observer/ptpe_observer.hpp).
std::vector<stats::PilotRating> answer_pilot(std::span<const ShownTrial> trials,
                                             std::span<const RealisedSetting> settings,
                                             const study::PtpeObserverParameters& observer,
                                             const RatedScale& scale, std::uint64_t key);

}  // namespace apps
