#pragma once
/// The simulated observer "ptpe": it rates a stimulus by the mean and standard deviation of its realised
/// frame rate.

#include <string>
#include <string_view>

#include "libstudy/observer/observer.hpp"

namespace study {

/// Latent satisfaction on a scale of K categories with midpoint m:
///
///   x = m + slope tau + effects + participant + noise,   tau = mu - a exp(b delta)   (paper Eq. 11)
///
/// with mu the harmonic mean and delta the standard deviation of the frames shown, participant ~ N(0,
/// participant_sd^2) drawn once for each person and noise ~ N(0, noise^2) once for each stimulus; effects is
/// added for a level of effects other than "none". The score is the category whose thresholds, m +- 1/2, 3/2,
/// ..., enclose x. They are symmetric about m, so that E[score] = m (4 on a 7-point scale) exactly on the
/// contour tau = 0 if effects is not added.
///
/// The default slope and noise give cell means over 16 people from about 1 to 6.5 on the pilot's grid, the
/// range of the paper's Fig. 6. The paper does not print the scatter of single people's scores, so noise and
/// participant_sd are our choice.
struct PtpeObserverParameters {
  double a = 0;                 ///< frames/s, > 0; must be given
  double b = 0;                 ///< s/frame, -1 to 1; must be given
  double slope = 0.14;          ///< scores per frame/s, > 0
  double noise = 1.0;           ///< standard deviation per stimulus, scores, >= 0
  double participant_sd = 0.5;  ///< standard deviation over participants, scores, >= 0
  double effects = 0;           ///< scores that a level with effects adds; recorded only if not 0
};

/// Reads "ptpe:a=31,b=0.035[,slope=..][,noise=..][,participant_sd=..][,effects=..]". base::Error, with the
/// position of the character, for another kind of observer, for a key that is unknown, repeated or missing,
/// and for a number that is wrong or out of range.
PtpeObserverParameters parse_ptpe_observer(std::string_view specification);

/// Answers the first question about a stimulus by the model. Of two stimuli the observer prefers the stimulus
/// with the larger latent satisfaction x; the noise of the two is independent. All other answers are
/// bystander_score().
class PtpeObserver final : public Observer {
 public:
  explicit PtpeObserver(const PtpeObserverParameters& parameters) : parameters_(parameters) {}
  std::optional<std::string> simulated() const override;
  int score(const Question& question, const Occasion& occasion, bool judges) const override;

 private:
  double latent(const Occasion& occasion, std::size_t interval) const;

  PtpeObserverParameters parameters_;
};

}  // namespace study
