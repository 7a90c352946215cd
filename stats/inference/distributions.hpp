#pragma once
/// Tail probabilities that are accurate relative to their size even in the far tails and for large counts,
/// where 1 - P and GSL's functions lose their digits. The functions of Student's t, central and noncentral,
/// throw std::invalid_argument if df is not positive, a probability is outside (0, 1), or an argument is NaN.

#include <array>

namespace stats {

/// The side of a test. Less: the parameter is below its null value. Greater: it is above it.
enum class Alternative { TwoSided, Less, Greater };

/// P(T <= t) and P(T >= t) of Student's t; df > 0 need not be whole. Relative error below 1e-11.
double student_lower(double t, double df);
double student_upper(double t, double df);

/// p-value of t: the tail that `alternative` names, or twice the smaller one.
double student_p(double t, double df, Alternative alternative);

/// Quantile of the upper tail: the t with P(T >= t) = p, to about 1e-13.
double student_upper_quantile(double p, double df);

/// P(T <= t) and P(T >= t) of the noncentral t, T = (Z + ncp) / sqrt(chi2(df) / df). Computed by the
/// trapezoidal rule, which converges exponentially (Trefethen and Weideman 2014): over the logarithm of the
/// chi variate for |ncp| <= 60, over the normal variate Z beyond. Relative error below 1e-11 for |ncp| <= 60.
double noncentral_t_lower(double t, double df, double ncp);
double noncentral_t_upper(double t, double df, double ncp);

/// Confidence interval of the noncentrality: at its lower end P(T >= t), and at its upper end P(T <= t), is
/// (1 - confidence)/2. Both ends times the ratio effect / t bound a standardised effect (Steiger and Fouladi
/// 1997; Cumming and Finch 2001).
std::array<double, 2> noncentrality_interval(double t, double df, double confidence = 0.95);

/// Hedges' factor, which removes the bias of a standardised difference with df degrees of freedom: G(df/2) /
/// (sqrt(df/2) G((df-1)/2)) with the gamma function G, exact (Hedges 1981). df > 1.
double hedges_factor(double df);

/// Upper tail of Fisher's F: P(F >= x), x >= 0, df1 and df2 above 0 (std::invalid_argument).
double fisher_upper(double x, double df1, double df2);

/// The deviance of a count x with expectation m > 0: x ln(x / m) + m - x, without cancellation; m at x = 0.
double deviance_part(double x, double m);

/// ln of the probability of k successes in n trials, p + q = 1, by Loader's saddle-point expansion (Loader
/// 2000): about 1e-14 absolute for any n. k and n may be fractions, 0 <= k <= n. -infinity if k is
/// impossible.
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

/// P(X > x) of chi-square; df > 0. Never 0 for a finite x: at least the smallest positive double.
double chi2_upper(double x, double df);
/// P(|Z| > |z|) of the standard normal. Never 0 for a finite z: at least the smallest positive double.
double normal_two_sided(double z);

/// exp(log_p), but at least the smallest positive double if log_p is finite: a probability too small for
/// double is not zero.
double probability(double log_p);

}  // namespace stats
