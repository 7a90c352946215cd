#pragma once
/// Psychometric functions: the probability of a response as a function of the stimulus.

#include <string_view>

#include "stats/result.hpp"

namespace stats {

/// Rising curves between a guess rate and 1 - lapse rate. All have the form
/// P(x) = guess + (1 - guess - lapse) F(x).
enum class PsychometricForm {
  Normal,      ///< F = Phi((x - threshold) / shape), with the standard normal distribution function Phi
  Logistic,    ///< F = 1 / (1 + exp(-(x - threshold) / shape))
  Weibull,     ///< F = 1 - exp(-(x / threshold)^shape) for x > 0, else 0
  WeibullLog,  ///< as Weibull, for x in decibels: (x / threshold) is 10^((x - threshold) / 20)
};

/// The word of a form in protocols: "normal", "logistic", "weibull", "weibull_db". psychometric_form()
/// returns the form of a word; refused: any other word.
const char* psychometric_word(PsychometricForm form);
Result<PsychometricForm> psychometric_form(std::string_view word);

struct PsychometricCurve {
  PsychometricForm form = PsychometricForm::Normal;
  double threshold = 0;  ///< threshold of F, in the unit of the stimulus
  double shape = 1;      ///< Normal: standard deviation; Logistic: scale; both Weibulls: exponent. Above 0
  double guess = 0;      ///< lower asymptote, 0 to 1
  double lapse = 0;      ///< 1 - upper asymptote, 0 to 1

  /// Probability of the response at stimulus x.
  double operator()(double x) const;
  /// Stimulus at which the probability is p. Refused: p is not between the asymptotes.
  Result<double> stimulus_at(double p) const;
};

}  // namespace stats
