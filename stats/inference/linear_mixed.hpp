#pragma once
/// Linear mixed models of answers: fixed terms, a random effect of the participant and a random effect of the
/// participant with each thing judged, by restricted maximum likelihood. This is the same model as R's lmer(y
/// ~ terms + (1 | participant) + (1 | participant:thing)) with lmerTest's degrees of freedom.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/ordinal/cumulative_link.hpp"
#include "stats/result.hpp"

namespace stats {

/// Test of a weighted sum of the coefficients of fixed terms against zero, two-sided.
struct MixedContrast {
  double estimate = 0, se = 0;
  double df = 0;  ///< Satterthwaite's (Giesbrecht and Burns 1985; Kuznetsova et al. 2017)
  double t = 0, p = 1;
  std::array<double, 2> ci{};
};

struct LinearMixedFit {
  std::vector<std::string> terms;        ///< terms that are estimated
  std::vector<std::string> left_out;     ///< terms that are combinations of earlier ones
  std::vector<double> beta, covariance;  ///< coefficients of `terms`, and their covariance (row-major)
  double sd_participant = 0;
  /// Standard deviation of the effect of a participant with a thing. Empty if no participant answered twice
  /// about one thing; this effect is then part of the residual.
  std::optional<double> sd_thing;
  double sd_residual = 0;
  double criterion = 0;  ///< -2 times the restricted log-likelihood
  int n = 0, participants = 0;
  /// Names, in words, the random effects whose standard deviation is estimated as zero; the fit is that of
  /// the model without them. Empty if there are none.
  std::string singular;
  /// Derivatives of `covariance` with respect to each nonzero ratio of a random effect's standard deviation
  /// to the residual's, then with respect to the residual's standard deviation. `parameter_covariance` is the
  /// covariance of the estimates of these parameters.
  std::vector<std::vector<double>> covariance_slopes;
  std::vector<double> parameter_covariance;

  /// Index of the term in `terms`; -1 if `terms` lacks it.
  int index_of(const std::string& term) const;
  /// Tests the weighted sum of `beta` against zero. One weight for each of `terms` (std::invalid_argument),
  /// not all zero; confidence in (0, 1).
  MixedContrast contrast(std::span<const double> weights, double confidence = 0.95) const;
};

/// Fits the model described at the top of this file. All columns have one length (std::invalid_argument); no
/// value is missing. Refused: fewer than two participants; no participant with two answers; no more answers
/// than terms; no residual variation; an infinite value; no convergence.
Result<LinearMixedFit> fit_linear_mixed(std::span<const double> y, std::span<const Predictor> terms,
                                        std::span<const int> participant, std::span<const int> thing);

}  // namespace stats
