#pragma once
/// Tail probabilities that stay accurate far out and for large counts, where GSL's lose their digits.

namespace stats {

/// The deviance of a count x with expectation m > 0: x ln(x / m) + m - x, without cancellation; m at x = 0.
double deviance_part(double x, double m);

/// ln of the probability of k successes in n trials, p + q = 1, by Loader's saddle-point expansion (Loader
/// 2000): about 1e-14 absolute for any n. k and n may be fractions, 0 <= k <= n. -infinity where impossible.
double log_binomial_mass(double k, double n, double p, double q);

/// ln of the regularised incomplete beta function I_x(a, b), a and b > 0, y = 1 - x: a continued fraction
/// (Press et al. 2007, section 6.4) times the exponential of log_binomial_mass. Swap (a, b) and (x, y) for
/// the upper tail.
double log_beta_lower(double a, double b, double x, double y);

/// The x at which I_x(a, b) is `probability`: found by bracketing in the logit of x, since gsl_cdf_beta_Pinv
/// returns NaN for some arguments. a, b >= 0.5, 0 < probability < 1 (std::invalid_argument).
double beta_quantile(double probability, double a, double b);

/// ln P(X <= k) and ln P(X >= k) of a binomial count; p + q = 1.
double log_binomial_lower(double k, double n, double p, double q);
double log_binomial_upper(double k, double n, double p, double q);

/// P(X > x) of chi-square; df > 0. Like probability(), never 0 for a finite x.
double chi2_upper(double x, double df);
/// P(|Z| > |z|) of the standard normal; never 0 for a finite z.
double normal_two_sided(double z);

/// exp(log_p), but at least the smallest positive double if log_p is finite: a probability too small for
/// double is not zero.
double probability(double log_p);

}  // namespace stats
