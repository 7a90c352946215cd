#include "stats/ptpe/ptpe.hpp"

#include <algorithm>
#include <cmath>

namespace stats {

double ptpe_threshold(const PtpeModel& model, double fps_sd) { return model.a * std::exp(model.b * fps_sd); }

double ptpe_tolerance(const PtpeModel& model, double fps_mean, double fps_sd) {
  return fps_mean - ptpe_threshold(model, fps_sd);
}

double activation_floor(const PtpeModel& model, double tolerance) {
  return std::exp(2 * model.b * std::min(tolerance, 0.0));
}

}  // namespace stats
