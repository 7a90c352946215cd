#include "libstudy/pacing/running_tolerance.hpp"

namespace study {

double RunningTolerance::next(std::int64_t submitted_ns) {
  const stats::FpsMoments known = window_.moments();
  if (last_ns_ >= 0 && submitted_ns > last_ns_) {
    window_.push(1e-9 * static_cast<double>(submitted_ns - last_ns_));
  }
  last_ns_ = submitted_ns;
  return known.frames == 0 ? 0 : stats::ptpe_tolerance(model_, known.mean, known.sd);
}

}  // namespace study
