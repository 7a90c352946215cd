#include "libsim/measure/limit_search.hpp"

#include <cmath>

namespace measure {

Limit<double> largest_factor(const Trial<double>& trial, double most, double resolution) {
  Limit<double> out{.reach = Reach::AllPass, .passed = most, .failed = trial(most), .runs = 1};
  if (out.failed.empty()) return out;
  out.reach = Reach::Found;
  out.passed = 1;
  // The tolerance keeps rounding from adding a bisection if the resolution divides the range exactly.
  for (double fails = most; fails / out.passed > resolution * (1 + 1e-9);) {
    const double middle = std::sqrt(fails * out.passed);
    ++out.runs;
    if (const std::string what = trial(middle); what.empty()) {
      out.passed = middle;
    } else {
      fails = middle;
      out.failed = what;
    }
  }
  return out;
}

Limit<int> fewest(const Trial<int>& trial, int usual) {
  Limit<int> out{.passed = usual, .failed = {}};
  for (int fails = 0; out.passed - fails > 1;) {
    const int middle = (fails + out.passed) / 2;
    ++out.runs;
    if (const std::string what = trial(middle); what.empty()) {
      out.passed = middle;
    } else {
      fails = middle;
      out.failed = what;
    }
  }
  if (out.passed == 1) out.reach = Reach::AllPass;
  return out;
}

}  // namespace measure
