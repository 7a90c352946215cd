#include "stats/adaptive/psychometric.hpp"

#include <gsl/gsl_cdf.h>

#include <array>
#include <cmath>
#include <string>

namespace stats {
namespace {

constexpr std::array psychometric_words{"normal", "logistic", "weibull", "weibull_db"};

/// Decibels per decade of amplitude.
constexpr double decade_db = 20;

}  // namespace

const char* psychometric_word(PsychometricForm form) {
  return psychometric_words[static_cast<std::size_t>(form)];
}

Result<PsychometricForm> psychometric_form(std::string_view word) {
  for (std::size_t i = 0; i < psychometric_words.size(); ++i)
    if (word == psychometric_words[i]) return static_cast<PsychometricForm>(i);
  return Refusal{"\"" + std::string(word) + "\" is not a psychometric function"};
}

double PsychometricCurve::operator()(double x) const {
  double f = 0;
  switch (form) {
    case PsychometricForm::Normal:
      f = gsl_cdf_ugaussian_P((x - threshold) / shape);
      break;
    case PsychometricForm::Logistic:
      f = 1 / (1 + std::exp(-(x - threshold) / shape));
      break;
    case PsychometricForm::Weibull:
      f = x > 0 ? -std::expm1(-std::pow(x / threshold, shape)) : 0;
      break;
    case PsychometricForm::WeibullLog:
      f = -std::expm1(-std::pow(10, shape * (x - threshold) / decade_db));
      break;
  }
  return guess + (1 - guess - lapse) * f;
}

Result<double> PsychometricCurve::stimulus_at(double p) const {
  const double f = (p - guess) / (1 - guess - lapse);
  if (!(f > 0 && f < 1)) return Refusal{"the probability is not between the guess rate and 1 - lapse rate"};
  switch (form) {
    case PsychometricForm::Normal:
      return threshold + shape * gsl_cdf_ugaussian_Pinv(f);
    case PsychometricForm::Logistic:
      return threshold + shape * std::log(f / (1 - f));
    case PsychometricForm::Weibull:
      return threshold * std::pow(-std::log1p(-f), 1 / shape);
    case PsychometricForm::WeibullLog:
      return threshold + decade_db / shape * std::log10(-std::log1p(-f));
  }
  return Refusal{"unknown form"};
}

}  // namespace stats
