#pragma once
/// Root finding for functions of one variable.

#include <functional>

namespace stats {

/// The root of a continuous f between `low` and `high`, to the resolution of double: Brent's method (Brent
/// 1973, ch. 4; GSL). f must not throw. std::invalid_argument when f(low) and f(high) have the same sign or
/// are not finite.
double find_root(const std::function<double(double)>& f, double low, double high);

}  // namespace stats
