#pragma once
/// What a sensor's log says about a presentation, as the database keeps it.

#include <cstdint>
#include <optional>
#include <string>

#include "libstudy/light/light_fit.hpp"

namespace study {

struct LightEvidence {
  ShowingLight light;
  std::optional<TimingGrade> grade;  ///< that the light earns (light_grade()); none: neither A nor B
  std::string why_not;               ///< what A lacks; empty: nothing
  std::string log_sha256;
  double interval_ms = 0, drift_ppm = 0;
  bool absolute = false;  ///< LightFit::absolute
};

}  // namespace study
