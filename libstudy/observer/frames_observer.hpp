#pragma once
/// The simulated observer that judges features of pictures and their timing.

#include <string>
#include <string_view>

#include "libstudy/observer/observer.hpp"

namespace study {

/// Quality of a stimulus in scores, 0 = neither good nor bad:
///
///   q = timing tanh(tau / 15) - grain log2(granularity / 8.5 px) - flicker log2(flicker / 0.02) + effects x
///
/// with tau = mu - 23.68 exp(0.02 delta) (the paper's PTPE@4.0) of the frames as they were shown and features
/// as in PictureFeatures. Realism and its like: nearest score to the scale's midpoint + q + participant +
/// noise. x is 1 if effects are a factor and the level is not "none", else 0. Symptoms (scales from 0, here
/// of 3 points; longer ones in proportion): 0.6 - sickness q + fatigue position + participant' + noise'. Of
/// two the second is preferred when q_2 - q_1 + bias + noise > 0. The weights are our choice: they order the
/// methods plausibly, and nothing in them was fitted to the paper's results.
struct FramesObserverParameters {
  double grain = 4;             ///< scores per octave, >= 0
  double flicker = 0.6;         ///< scores per octave, >= 0
  double timing = 1.2;          ///< scores, >= 0
  double noise = 0.9;           ///< scores, >= 0
  double participant_sd = 0.5;  ///< scores, >= 0
  double bias = 0;              ///< scores in favour of the second interval
  double effects = 0;           ///< scores that effects add; recorded only if not 0
  double sickness = 0.25;       ///< symptom scores per score of quality, >= 0
  double fatigue = 0.02;        ///< symptom scores per unit of the session, >= 0
};

/// "frames" or "frames:key=number,..."; base::Error naming the place.
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
