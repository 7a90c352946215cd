#include "libstudy/pacing/schedule.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace study {

PacingRules for_display(PacingRules rules, double refresh_hz) {
  if (rules.fps_max_is_refresh && refresh_hz > 0) rules.fps_max = refresh_hz;
  rules.fps_max_is_refresh = false;
  return rules;
}

std::string setting_name(const FpsSetting& setting) {
  char text[64];
  std::snprintf(text, sizeof text, "(%g, %g)", setting.mean, setting.sd);
  return text;
}

std::int64_t frame_count(const FpsSetting& setting) {
  return std::max<std::int64_t>(1, std::llround(setting.mean * setting.duration_s));
}

}  // namespace study
