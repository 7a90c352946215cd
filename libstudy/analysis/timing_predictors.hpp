#pragma once
/// What people may notice of a trial's timing: numbers that are computed from its real frame times, and the
/// rival models made of them.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace study {

/// The predictors. Frame times dt are in the order in which the frames were shown.
enum class TimingPredictor {
  MeanRate,        ///< log of the harmonic mean of the frame rate, N / sum(dt), frames/s
  ArithmeticRate,  ///< log of the arithmetic mean of 1/dt, frames/s
  RateSd,          ///< standard deviation (divisor N) of 1/dt, frames/s; delta of the PTPE
  FrameTimeSd,     ///< standard deviation (divisor N) of dt, ms
  P95,             ///< log(1000 / 95th percentile of dt in ms)
  P99,             ///< log(1000 / 99th percentile of dt in ms)
  Longest,         ///< log(1000 / longest dt in ms)
  Hitches,         ///< log(1 + number of dt longer than hitch_factor times the median), as in the certificate
  Steps,           ///< log(1 + root mean square difference of successive dt in ms); depends on their order
  AnimationError   ///< log(1 + mean absolute difference in ms between the step of the simulated time and dt)
};
inline constexpr std::size_t timing_predictor_count = 10;
using TimingPredictors = std::array<double, timing_predictor_count>;  ///< by TimingPredictor

/// animation_error_ms: as recorded for the showing (presentation.animation_error_ms); without it
/// AnimationError is NaN. std::invalid_argument if there is no interval or one is not positive and finite.
TimingPredictors timing_predictors(std::span<const double> intervals_s,
                                   std::optional<double> animation_error_ms = {});

/// Name in options and JSON, such as "p95"; "log of the harmonic mean of the frame rate" in words.
const char* predictor_name(TimingPredictor predictor);
const char* predictor_words(TimingPredictor predictor);

/// A model of what people notice: v = x_1, or v = x_1 - b x_2.
struct TimingModel {
  std::string name;                         ///< such as "p95", "ptpe" or "p95+hitches"
  std::vector<TimingPredictor> predictors;  ///< one or two

  bool uses(TimingPredictor one) const;
  double value(const TimingPredictors& of, std::size_t predictor) const {
    return of[static_cast<std::size_t>(predictors[predictor])];
  }
};

/// The models that are compared without --models: each predictor but RateSd, Steps and AnimationError
/// alone, and "ptpe", log mu - b delta.
std::vector<TimingModel> usual_timing_models();
/// Reads "ptpe,p95,longest+hitches": names of predictors, "ptpe", or two predictors joined by '+'.
/// base::Error for an unknown name, fewer than two models, and a model given twice, also with its predictors
/// in another order.
std::vector<TimingModel> parse_timing_models(const std::string& text);
/// The models with these names. place: where they stand, for messages. base::Error as parse_timing_models().
std::vector<TimingModel> timing_models(const std::vector<std::string>& names, const std::string& place);
/// True if `wide` has all predictors of `narrow` and more: with a coefficient of 0 it is `narrow`.
bool contains(const TimingModel& wide, const TimingModel& narrow);

}  // namespace study
