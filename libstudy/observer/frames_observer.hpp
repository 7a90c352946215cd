#pragma once
/// The simulated observer "frames": it rates a stimulus by features of its pictures and by its frame rate.

#include <string>
#include <string_view>

#include "libstudy/observer/observer.hpp"

namespace study {

/// Parameters of the quality q of a stimulus, in scores; q = 0 is neither good nor bad:
///
///   q = timing tanh(tau / 15) - grain log2(granularity / 8.5 px) - flicker log2(flicker / 0.02) + effects x
///
/// tau = mu - 23.68 exp(0.02 delta) (the paper's PTPE@4.0), with harmonic mean mu and standard deviation
/// delta of the shown frame rate. The features granularity and flicker are those of PictureFeatures. x is 1
/// for a level of effects other than "none", else 0. A rating is the score nearest to the scale's midpoint +
/// q + participant + noise; for a Vas see rated_score(). A symptom, on a scale from 0 to 3, is the score
/// nearest to 0.6 - sickness q + fatigue position + participant' + noise', scaled to longer scales in
/// proportion; noise' has half the standard deviation of noise, and of two stimuli the smaller q counts. The
/// second of two stimuli is preferred if q_2 - q_1 + bias + noise > 0. The default weights are our choice:
/// they rank the methods plausibly and were not fitted to the paper's results.
struct FramesObserverParameters {
  double grain = 4;             ///< scores per octave of granularity, >= 0
  double flicker = 0.6;         ///< scores per octave of flicker, >= 0
  double timing = 1.2;          ///< largest gain or loss by tau, scores, >= 0
  double noise = 0.9;           ///< standard deviation per answer, scores, >= 0; half of it for a symptom
  double participant_sd = 0.5;  ///< standard deviation over participants, scores, >= 0
  double bias = 0;              ///< scores in favour of the second interval
  double effects = 0;           ///< scores that a level with effects adds; recorded only if not 0
  double sickness = 0.25;       ///< symptom scores per score of quality, >= 0
  double fatigue = 0.02;        ///< symptom scores added with each unit of the session, >= 0
};

/// Reads "frames" or "frames:key=number,..."; base::Error names the character of an error.
FramesObserverParameters parse_frames_observer(std::string_view specification);

class FramesObserver final : public Observer {
 public:
  FramesObserver(const FramesObserverParameters& parameters, FeatureSource& features)
      : parameters_(parameters), features_(features) {}
  std::optional<std::string> simulated() const override;
  int score(const Question& question, const Occasion& occasion, bool judges) const override;
  bool feels() const override { return true; }

  double quality(const ShownStimulus& shown) const;

 private:
  int symptom(const Question& question, const Occasion& occasion) const;

  FramesObserverParameters parameters_;
  FeatureSource& features_;
};

}  // namespace study
