#pragma once
/// Finds by bisection how far a number can be changed before something fails.

#include <functional>
#include <string>

namespace measure {

/// Runs with the changed number; returns what failed, empty if nothing did.
template <class T>
using Trial = std::function<std::string(T)>;

enum class Reach {
  Found,      ///< between what passed and what failed
  AllPass,    ///< even the farthest value tried passes
  UsualFails  ///< the usual value itself fails
};

template <class T>
struct Limit {
  Reach reach = Reach::Found;
  T passed{};          ///< the farthest value that passed; the usual one if that fails
  std::string failed;  ///< what failed at the nearest failing value; empty if all pass
  int runs = 0;
};

/// The largest factor from 1 to `most` that passes, if 1 does: the smallest failing factor is at most
/// `resolution` times larger. Assumes that all factors below a passing one pass; only the bisection's points
/// are tried. most > 1, resolution > 1.
Limit<double> largest_factor(const Trial<double>& trial, double most, double resolution);

/// The smallest whole number from 1 to `usual` that passes, if `usual` does. Assumes that all numbers between
/// a passing one and `usual` pass.
Limit<int> fewest(const Trial<int>& trial, int usual);

}  // namespace measure
