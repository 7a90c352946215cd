#pragma once
/// Cumulative-link (ordered) regression of ratings (McCullagh 1980): P(Y <= j) = F(theta_j - x beta), with
/// or without a normal random effect of the participant.

#include <span>
#include <string>
#include <vector>

#include "stats/result.hpp"

namespace stats {

/// Link distributions of ratings: P(Y <= j) = F(theta_j - location).
enum class Link { Logit, Probit };

const char* link_name(Link link);  ///< "logit", "probit"

/// Distribution function F, its density f and the density's first two derivatives f1 and f2 at x. At
/// -infinity F is 0 and at +infinity F is 1; f, f1 and f2 are then 0.
struct LinkValue {
  double F = 0, f = 0, f1 = 0, f2 = 0;
};
LinkValue link_value(Link link, double x);

/// x with F(x) = p, 0 < p < 1 (std::invalid_argument).
double link_quantile(Link link, double p);

/// log P of one rating, P = F(upper - v) - F(lower - v), and its derivatives: d1, d2, d3 with respect to the
/// location v; `up` and `lo` with respect to the upper and lower threshold, `up1`, `up2`, `lo1`, `lo2` are
/// the first and second derivatives of `up` and `lo` with respect to v.
struct CategoryTerm {
  double log_p = 0;
  double d1 = 0, d2 = 0, d3 = 0;
  double up = 0, up1 = 0, up2 = 0;
  double lo = 0, lo1 = 0, lo2 = 0;
  double up_up = 0, lo_lo = 0, up_lo = 0;  ///< second derivatives with respect to the thresholds
};

/// lower < upper; either may be infinite. log_p is -infinity where P is below the smallest normal double, and
/// the derivatives are then zero.
CategoryTerm category_term(Link link, double lower, double upper, double location);

/// One column of the design; NaN = missing.
struct Predictor {
  std::string name;
  std::vector<double> values;
};

/// Indicator columns of all groups except the reference, in ascending order of their numbers, named `name` +
/// number. A NaN group counts as missing. std::invalid_argument if no row has the reference group.
std::vector<Predictor> indicators(const std::string& name, std::span<const double> groups, double reference);

struct OrdinalFit {
  Link link = Link::Logit;
  std::vector<double> levels;      ///< scores that occur, ascending; unused scores have no threshold
  std::vector<double> thresholds;  ///< one fewer than levels, ascending
  std::vector<double> beta;        ///< coefficient of each predictor; above 0: larger values go with higher
                                   ///< ratings
  /// Covariance of thresholds, then beta; row-major, from the observed information.
  std::vector<double> covariance;
  double log_likelihood = 0;
  int n = 0;          ///< rows used
  int n_missing = 0;  ///< rows with a NaN, left out

  /// Standard errors of thresholds, then beta.
  std::vector<double> se() const;
};

/// Maximum likelihood by Newton's method on the concave log-likelihood. All columns have one length
/// (std::invalid_argument). Refused: no rows; all ratings equal; a predictor that is constant or a linear
/// combination of the others; an infinite value; separation (the reason names its predictors): the predictors
/// separate the ratings so that the likelihood has no maximum (Albert and Anderson 1984).
Result<OrdinalFit> fit_cumulative_link(std::span<const double> ratings, std::span<const Predictor> predictors,
                                       Link link = Link::Logit);

/// How a fit treats ratings that the predictors separate (see fit_cumulative_link()).
enum class Separation {
  Refuse,
  /// Maximise the likelihood times the log-F(1, 1) density of each beta (Greenland and Mansournia 2015, Stat.
  /// Med. 34, 3133-3143): exp(beta / 2) / (1 + exp(beta)), so that the log-likelihood is reduced by log
  /// cosh(beta / 2). The maximum is finite even under separation. For one log odds ratio this is Jeffreys'
  /// prior, as used by Firth (1993, Biometrika 80, 27-38). Unlike that prior it needs no information matrix,
  /// for which the mixed model has no closed form. 95 % of the prior's odds ratios lie between 1/648 and 648.
  Penalise
};

/// A fit with location x beta + s_p, where s_p ~ N(0, sd^2) is drawn once for each participant.
struct MixedOrdinalFit : OrdinalFit {
  double sd_participant = 0;  ///< 0 or more; 0 if the model without differences between participants fits
                              ///< best
  int participants = 0;
  int points = 1;             ///< nodes of the quadrature; 1 is Laplace's approximation
  std::string why_penalised;  ///< the separation found; empty: maximum likelihood was used
  double log_prior = 0;  ///< log prior of a penalised fit relative to beta = 0; log_likelihood excludes it
  double objective() const { return log_likelihood + log_prior; }  ///< the value that was maximised
};

/// Maximum likelihood by adaptive Gauss-Hermite quadrature with `points` nodes over each participant's effect
/// (Pinheiro and Bates 1995; 1 = Laplace), 1 to 101 (std::invalid_argument). Refused as
/// fit_cumulative_link(), and also: fewer than two participants; one rating from each participant, from which
/// sd_participant cannot be separated from the scatter of single ratings; an unbounded sd_participant; no
/// convergence. Separation::Penalise changes nothing if the ratings are not separated; it requires beta to be
/// log odds (std::invalid_argument with the probit link), and the covariance is that of the penalised
/// likelihood.
Result<MixedOrdinalFit> fit_cumulative_link_mixed(std::span<const double> ratings,
                                                  std::span<const Predictor> predictors,
                                                  std::span<const int> participants, Link link = Link::Logit,
                                                  int points = 15,
                                                  Separation separation = Separation::Refuse);

/// Likelihood-ratio test of nested fits to the same rows.
struct LikelihoodRatio {
  double chi2 = 0;  ///< 2 (log L full - log L reduced), at least 0
  int df = 0;
  double p = 1;
};
/// Compares two nested fits that differ by df parameters. std::invalid_argument unless df >= 1.
LikelihoodRatio likelihood_ratio(double log_likelihood_full, double log_likelihood_reduced, int df);

}  // namespace stats
