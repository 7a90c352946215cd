#pragma once
/// Simulated answers to planned trials.

#include <cstdint>
#include <span>
#include <vector>

#include "libstudy/power/worlds.hpp"
#include "stats/analysis/score_table.hpp"
#include "stats/analysis/task2.hpp"
#include "stats/ptpe/pilot.hpp"

namespace study {

/// Standard deviations of Task 1's latent answers, in points. A participant's own level cancels in pairs.
struct Task1Scatter {
  static constexpr double participant_share = 0.6;  ///< SD of participants' levels / SD of the differences
  AnswerScale answers = AnswerScale::Likert;
  double participant_realism = 0, participant_sickness = 0;
  double method_realism = 0, method_sickness = 0;  ///< of the effect of person by method, the same at every
                                                   ///< n_*
  double noise_realism = 0;
  double noise_sickness = 0;  ///< shared by the four items of a report
  double noise_item = 0;
  double realism_min = 1, realism_max = 7, item_min = 0, item_max = 3;
};

/// Scatter for which the difference between two methods' answers has the requested standard deviation, away
/// from the ends of the scale. This includes the variance from rounding, 1/12 per answer (Sheppard).
/// base::Error if the request is less than rounding alone.
Task1Scatter task1_scatter(const PowerRequest& request);

struct Task1Answers {
  std::vector<stats::MethodScore> realism, sickness;  ///< by participant
};

/// Answers depend only on the key and the trial, not on the number of other trials.
Task1Answers answer_task1(std::span<const ShownTrial> trials, const ShownFactors& factors,
                          const Scenario& truth, const Task1Scatter& scatter, std::uint64_t key);

std::vector<stats::PairChoice> answer_task2(std::span<const ShownTrial> trials, const ShownFactors& factors,
                                            const Scenario& truth, double interval_bias, std::uint64_t key);

/// The realised frame rates of a setting.
struct RealisedSetting {
  double mu = 0, delta = 0;  ///< nominal
  double harmonic = 0, arithmetic = 0, sd = 0;
};

/// Compiles each cell's schedule once; its moments do not depend on its order.
std::vector<RealisedSetting> realised_settings(const Protocol& protocol);

/// Range of scores, and the level at which the observer's curve is the contour of the mean score.
struct RatedScale {
  int min = 1, max = 7;
  double level = 4;
};

/// Ratings by the parametric observer (libstudy/observer/ptpe_observer.hpp).
std::vector<stats::PilotRating> answer_pilot(std::span<const ShownTrial> trials,
                                             std::span<const RealisedSetting> settings,
                                             const PtpeObserverParameters& observer, const RatedScale& scale,
                                             std::uint64_t key);

}  // namespace study
