#include "libstudy/pacing/schedule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libstudy/pacing/exact_rates.hpp"
#include "libstudy/pacing/frame_order.hpp"
#include "libstudy/pacing/whole_nanoseconds.hpp"

namespace study {

PacingRules for_display(PacingRules rules, double refresh_hz) {
  if (rules.fps_max_is_refresh && refresh_hz > 0) rules.fps_max = refresh_hz;
  rules.fps_max_is_refresh = false;
  return rules;
}

std::string setting_name(const FpsSetting& setting) {
  return fmt::format("({:g}, {:g})", setting.mean, setting.sd);
}

std::int64_t frame_count(const FpsSetting& setting) {
  return std::max<std::int64_t>(1, std::llround(setting.mean * setting.duration_s));
}

Schedule compile_schedule(const FpsSetting& setting, const PacingRules& rules, std::uint64_t seed) {
  Schedule schedule;
  for (const double rate : ordered(exact_rates(setting, rules), rules, seed))
    schedule.intervals_s.push_back(1 / rate);
  schedule.intervals_ns = whole_nanoseconds(schedule.intervals_s, setting, rules.mean);
  return schedule;
}

}  // namespace study
