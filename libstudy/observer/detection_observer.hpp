#pragma once
/// A simulated observer that detects one property of the timing, such as hitches.

#include <optional>
#include <string>
#include <string_view>

#include "libstudy/observer/observer.hpp"

namespace study {

/// Detects a stimulus of value x, the number of its timing profile under the key `axis`, with the probability
///
///   F = (1 - lapse) (1 - exp(-(x / t)^shape)),   t = threshold exp(spread z)
///
/// where z ~ N(0, 1) is drawn once for each person. F is 0 for x <= 0. If the profile lacks the key, x is 0.
/// A single stimulus gets the question's highest score if it is detected. If it is not detected, it gets the
/// highest score with probability guess, else the lowest. Of a pair, the observer chooses the interval with
/// the smaller x if the larger x is detected and the two differ, else either interval at random.
struct DetectionParameters {
  std::string axis;      ///< key in the timing profile, such as "hitch_ms"
  double threshold = 0;  ///< in the unit of the axis, > 0; must be given
  double shape = 3;      ///< exponent of the Weibull function, > 0
  double guess = 0;      ///< probability of a false alarm, 0 to 1
  double lapse = 0.02;   ///< probability of missing even the largest stimulus, 0 to 1
  double spread = 0;     ///< standard deviation of ln(threshold) over people, 0 to 10
};

/// Reads "detect:hitch_ms,threshold=60[,shape=3][,guess=0][,lapse=0.02][,spread=0]". base::Error naming the
/// place for anything else.
DetectionParameters parse_detection_observer(std::string_view specification);

class DetectionObserver final : public Observer {
 public:
  explicit DetectionObserver(DetectionParameters parameters) : parameters_(std::move(parameters)) {}
  std::optional<std::string> simulated() const override;
  int score(const Question& question, const Occasion& occasion, bool judges) const override;

 private:
  /// Probability of detecting a stimulus of this value.
  double detection(const Occasion& occasion, double x) const;

  DetectionParameters parameters_;
};

}  // namespace study
