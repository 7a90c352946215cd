#include "stats/ptpe/ptpe.hpp"

#include <algorithm>
#include <cmath>

namespace stats {

double ptpe_threshold(const PtpeModel& model, double fps_sd) { return model.a * std::exp(model.b * fps_sd); }

double ptpe_tolerance(const PtpeModel& model, double fps_mean, double fps_sd) {
  return fps_mean - ptpe_threshold(model, fps_sd);
}

double ptpe_tolerance(const PtpeModel& model, const FpsMoments& shown) {
  return ptpe_tolerance(model, shown.mean_of(model.mean), shown.sd);
}

double activation_floor(const PtpeModel& model, double tolerance) {
  return std::min(1.0, std::exp(2 * model.b * std::min(tolerance, 0.0)));
}

}  // namespace stats
