#pragma once
/// Tail probabilities of Student's t, central and noncentral. They are accurate relative to their size even
/// in the far tails, where 1 - P would lose all digits. std::invalid_argument if df is not positive, a
/// probability is outside (0, 1), or an argument is NaN.

#include <array>

#include "stats/inference/alternative.hpp"

namespace stats {

/// P(T <= t) and P(T >= t) of Student's t; df > 0 need not be whole. Relative error below 1e-11.
double student_lower(double t, double df);
double student_upper(double t, double df);

/// p-value of t: the tail that `alternative` names, or twice the smaller one.
double student_p(double t, double df, Alternative alternative);

/// Quantile of the upper tail: the t with P(T >= t) = p, to about 1e-13.
double student_upper_quantile(double p, double df);

/// P(T <= t) and P(T >= t) of the noncentral t, T = (Z + ncp) / sqrt(chi2(df) / df). Computed by the
/// trapezoidal rule over the logarithm of the chi variate, which converges exponentially (Trefethen and
/// Weideman 2014) and, unlike a series, does not break down at a large ncp. Relative error below 1e-11.
double noncentral_t_lower(double t, double df, double ncp);
double noncentral_t_upper(double t, double df, double ncp);

/// The noncentralities for which t lies at the upper and at the lower (1 - confidence)/2 point. Divided by
/// its scale, this is the interval of a standardised effect (Steiger and Fouladi 1997; Cumming and Finch
/// 2001).
std::array<double, 2> noncentrality_interval(double t, double df, double confidence = 0.95);

/// Hedges' factor, which removes the bias of a standardised difference with df degrees of freedom: G(df/2) /
/// (sqrt(df/2) G((df-1)/2)), exact (Hedges 1981). df > 1.
double hedges_factor(double df);

/// Upper tail of Fisher's F, x >= 0.
double fisher_upper(double x, double df1, double df2);

}  // namespace stats
