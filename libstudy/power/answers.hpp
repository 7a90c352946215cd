#pragma once
/// Simulates answers to planned trials.

#include <cstdint>
#include <span>
#include <vector>

#include "libstudy/power/worlds.hpp"
#include "stats/analysis/score_table.hpp"
#include "stats/analysis/task2.hpp"
#include "stats/ptpe/pilot.hpp"

namespace study {

/// Standard deviations of the parts of Task 1's latent answers, in points of the scale. The part of the
/// participant is equal for all methods, so differences between methods do not depend on it.
struct Task1Scatter {
  /// Standard deviation of the part of the participant, divided by the standard deviation of the difference
  /// between methods.
  static constexpr double participant_share = 0.6;
  AnswerScale answers = AnswerScale::Likert;
  double participant_realism = 0, participant_sickness = 0;
  double method_realism = 0, method_sickness = 0;  ///< SD of the interaction of person and method
  double noise_realism = 0;                        ///< SD of the part of each single answer
  double noise_sickness = 0;  ///< SD of the part common to the four items of cybersickness about one trial
  double noise_item = 0;      ///< SD of the part of each single item of cybersickness
  double realism_min = 1, realism_max = 7, item_min = 0, item_max = 3;
};

/// Scatter for which the difference between two methods' answers has the requested standard deviation, as
/// long as no answer is cut off at an end of the scale. With AnswerScale::Likert, this includes the variance
/// from rounding, 1/12 per answer (Sheppard). base::Error if rounding and the interaction of person and
/// method alone exceed the requested standard deviation, or if the protocol lacks a question of Task 1.
Task1Scatter task1_scatter(const PowerRequest& request);

struct Task1Answers {
  std::vector<stats::MethodScore> realism, sickness;  ///< scores, ordered by participant
};

/// Simulates the answers to these trials. `key`: seed of the study's random numbers. An answer does not
/// depend on the other trials.
Task1Answers answer_task1(std::span<const ShownTrial> trials, const ShownFactors& factors,
                          const Scenario& truth, const Task1Scatter& scatter, std::uint64_t key);

std::vector<stats::PairChoice> answer_task2(std::span<const ShownTrial> trials, const ShownFactors& factors,
                                            const Scenario& truth, double interval_bias, std::uint64_t key);

/// Nominal and realised moments of a frame-rate setting, in frames/s.
struct RealisedSetting {
  double mu = 0, delta = 0;                     ///< nominal mean and standard deviation
  double harmonic = 0, arithmetic = 0, sd = 0;  ///< realised means and standard deviation
};

/// The moments of each cell of the design, from one compiled schedule each. The order of the frames in a
/// schedule does not change its moments.
std::vector<RealisedSetting> realised_settings(const Protocol& protocol);

/// Range of the scale's scores. `level`: mean score of the observer on its curve mu = a exp(b delta), where
/// mu is the harmonic mean and delta the standard deviation of the frame rate.
struct RatedScale {
  int min = 1, max = 7;
  double level = 4;
};

/// Simulates the ratings of a pilot by the parametric observer (libstudy/observer/ptpe_observer.hpp).
std::vector<stats::PilotRating> answer_pilot(std::span<const ShownTrial> trials,
                                             std::span<const RealisedSetting> settings,
                                             const PtpeObserverParameters& observer, const RatedScale& scale,
                                             std::uint64_t key);

}  // namespace study
