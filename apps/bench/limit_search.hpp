#pragma once
/// How far a number may be turned before something fails, by bisection.

#include <functional>
#include <string>

namespace apps {

/// Runs with a number turned; gives what failed, empty when nothing did.
template <class T>
using Trial = std::function<std::string(T)>;

enum class Reach {
  Found,      ///< between what passed and what failed
  AllPass,    ///< also the farthest that was tried
  UsualFails  ///< nothing was turned
};

template <class T>
struct Limit {
  Reach reach = Reach::Found;
  T passed{};          ///< the farthest that passed; the usual one where that fails
  std::string failed;  ///< what failed at the nearest that did; empty when all pass
  int runs = 0;
};

/// The largest factor from 1 to `most` that passes, where 1 does: between it and the smallest that failed
/// lies at most the factor `resolution`. What passes at a factor is taken to pass at all smaller ones;
/// between the ends only the bisection's own points are tried. most > 1, resolution > 1.
Limit<double> largest_factor(const Trial<double>& trial, double most, double resolution);

/// The smallest whole number from 1 to `usual` that passes, where `usual` does. What passes with a number is
/// taken to pass with all larger ones up to it.
Limit<int> fewest(const Trial<int>& trial, int usual);

}  // namespace apps
