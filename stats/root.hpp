#pragma once
/// Root finding for functions of one variable.

#include <functional>

namespace stats {

/// A root of a continuous f between `low` and `high`: Brent's method (Brent 1973, ch. 4; GSL) until the
/// bracket is narrower than 1e-15 of the root, at most 100 iterations. f must not throw.
/// std::invalid_argument when f(low) and f(high) are not finite or have the same sign, unless one of them is
/// 0.
double find_root(const std::function<double(double)>& f, double low, double high);

}  // namespace stats
