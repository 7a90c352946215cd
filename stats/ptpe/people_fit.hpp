#pragma once
/// Each person's own threshold curve mu = a_p exp(b_p delta) of mean frame rates mu over standard deviations
/// delta, with partial pooling: an ordinal model in which log a and b are normal over people. A person's
/// estimate leans on the other people, the more the less the person's own answers say.
///
///   P(Y <= j) = (1 - lapse) Phi(theta_j - L) + lapse (j + 1) / choices
///   L = v (k + m delta + q v) + drift t,   v = log mu - log a_p - b_p delta
///   (log a_p, b_p) ~ N((log a, b), Sigma)
///
/// t is the place of the trial in the session, from -1/2 to 1/2. The thresholds are held so that a person's
/// expected answer without lapses equals the level at v = 0 and t = 0. So v = 0, which is tau = mu - a_p
/// exp(b_p delta) = 0, is the person's contour of this level. a and b are the contour of the person in the
/// middle of the population. The other estimators fit the contour of the mean score over people
/// (ordinal_pilot.hpp); the two are equal if answers above and below the level are spaced alike.
///
/// With m = q = 0 this is a cumulative link mixed model with random intercepts and slopes for delta, as
/// ordinal::clmm in R fits it: coefficients k for log mu and -k b for delta.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/ptpe/curve.hpp"
#include "stats/ptpe/pilot.hpp"
#include "stats/result.hpp"

namespace stats {

/// Below it the spread over people is not estimated.
inline constexpr int least_people_to_pool = 5;
/// Below it the settings do not determine the surface.
inline constexpr int least_settings_to_pool = 6;
/// A person's contour with a smaller own_share is called the population's.
inline constexpr double least_own_share = 0.5;
/// PersonContour::log_mu_sd beyond which a person has no contour of the person's own: the ends of the 95 %
/// interval of mu then differ by more than a factor of two.
inline constexpr double largest_log_mu_sd = 0.18;

struct PeopleOptions {
  bool straight = false;  ///< hold m = q = 0
  bool drift = true;      ///< estimate the drift, if the positions of all trials are known
  /// Lapse rate, 0 to below 0.5; none: estimated, between 0.005 and 0.5, with a normal prior of its parameter
  /// as in rival_fit.hpp.
  std::optional<double> lapse = {};
  /// Multiply the likelihood by the square root of det Sigma, which keeps SDs above 0 and correlations inside
  /// -1 to 1 (Chung and others 2015, J. Educ. Behav. Stat. 40, 136-157). Without it the estimate of an SD is
  /// 0 in many studies, and people's intervals are too narrow.
  bool hold_spread = true;
  int points = 5;   ///< nodes of the quadrature for each of a person's two effects, 3 or more
  int choices = 7;  ///< number of scores on the scale
  double confidence = 0.95;
};

/// An estimate of a curve with the covariance of log a and b.
struct CurveMoments {
  Curve curve;
  double var_log_a = 0, cov = 0, var_b = 0;

  double log_mu_sd(double delta) const;  ///< standard deviation of log mu(delta)
};

/// An estimate that cannot be below 0 (SD) or outside -1 to 1 (correlation), with its interval.
struct SpreadEstimate {
  double value = 0;
  std::array<double, 2> ci{};
};

struct PersonContour {
  int participant = 0;  ///< PilotRating::participant
  int answers = 0, settings = 0;
  bool same_answer = false;  ///< all answers of the person are equal
  /// Mean and covariance of the person's (log a_p, b_p), given all answers. The covariance includes the
  /// uncertainty of the parameters that all people share (Kass and Steffey 1989, J. Am. Stat. Assoc. 84,
  /// 717-726).
  CurveMoments pooled;
  std::array<double, 2> a_ci{}, b_ci{};
  /// The most likely curve by the person's answers alone, with k, m, q, drift, thresholds and lapse rate of
  /// all people. Refused if the answers do not determine it.
  Result<CurveMoments> alone = Refusal{"not computed"};
  /// 1 - (variance of log mu(delta) given the answers) / (variance over people), over the deltas shown: 0 if
  /// the person's own answers say nothing, 1 if they say all.
  double own_share = 0;
  std::vector<double> in_reach;  ///< nominal deltas at which the curve lies among the frame rates shown
  bool out_of_reach = false;     ///< the curve lies outside them at more than half of the deltas shown
  double log_mu_sd = 0;          ///< root mean square of the SD of log mu(delta), over the ratings' deltas

  /// Why the answers do not determine a contour of the person's own, as a phrase; empty: they do.
  std::string doubt() const;
  std::array<double, 2> band(double delta, double confidence) const;  ///< interval of mu_p(delta)
};

struct PeopleFit {
  double level = 4;
  /// From the observed information; intervals with Student's t, by Satterthwaite's degrees of freedom.
  CurveSpread population;
  SpreadEstimate sd_log_a, sd_b, correlation;  ///< over people, at delta = 0
  double k = 0, m = 0, q = 0;                  ///< on the probit scale
  std::optional<SpreadEstimate> drift;  ///< change of L from the first to the last trial; none: not estimated
  double lapse = 0;
  std::vector<double> levels, thresholds;
  double log_likelihood = 0;  ///< without the priors
  int n = 0, settings = 0;
  std::vector<double> deltas;         ///< nominal, ascending
  std::vector<double> in_reach;       ///< deltas at which the population's curve lies among the rates shown
  std::vector<PersonContour> people;  ///< by ascending participant
};

/// Refused: fewer than least_people_to_pool people with answers to three or more settings; fewer than
/// least_settings_to_pool settings, or a single delta; all answers equal; a level not between the lowest and
/// the highest answer; what fit_ordinal_pilot(), which gives the start, refuses; no convergence; answers that
/// do not rise with the frame rate along the curve. std::invalid_argument for options outside their ranges.
Result<PeopleFit> fit_people(std::span<const PilotRating> ratings, PilotMean mean, double level,
                             const PeopleOptions& options = {});

}  // namespace stats
