#include "libstudy/pacing/nominal_refresh.hpp"

#include <cmath>

namespace study {

namespace {

double share_between(double hz, double other_hz) { return std::abs(hz / other_hz - 1); }

}  // namespace

double nominal_refresh(double hz, double reported_hz) {
  const double base_hz = reported_hz > 0 && share_between(hz, reported_hz) < same_refresh ? reported_hz : hz;
  const double whole_hz = std::round(base_hz);
  double best_hz = share_between(base_hz, whole_hz) <= measured_refresh ? whole_hz : base_hz;
  double least = same_refresh;
  for (const double usual : usual_refreshes) {
    if (share_between(hz, usual) >= same_refresh || share_between(base_hz, usual) >= least) continue;
    best_hz = usual;
    least = share_between(base_hz, usual);
  }
  return best_hz;
}

}  // namespace study
