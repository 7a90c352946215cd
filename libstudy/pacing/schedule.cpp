#include "libstudy/pacing/schedule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "libstudy/pacing/exact_rates.hpp"
#include "libstudy/pacing/frame_order.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

constexpr double bound = 1e-6;

/// Sums that give mean and standard deviation. With them, changing one interval costs constant time.
struct Sums {
  long double time = 0, rate = 0, square = 0;

  void add(std::int64_t interval_ns, int sign) {
    const long double dt = 1e-9L * static_cast<long double>(interval_ns);
    time += sign * dt;
    rate += sign / dt;
    square += sign / (dt * dt);
  }

  /// The larger of two errors: of the mean, relative to setting.mean; of the standard deviation, relative to
  /// the larger of setting.sd and 1 frame/s.
  double error(std::size_t count, const FpsSetting& setting, FpsMean mean) const {
    const auto n = static_cast<long double>(count);
    const long double mean_rate = rate / n;
    const long double realised = mean == FpsMean::Harmonic ? n / time : mean_rate;
    const long double sd = std::sqrt(std::max(0.0L, square / n - mean_rate * mean_rate));
    return static_cast<double>(std::max(std::abs(realised / setting.mean - 1),
                                        std::abs(sd - setting.sd) / std::max(1.0, setting.sd)));
  }
};

std::vector<std::int64_t> rounded_deadlines(const std::vector<double>& intervals_s) {
  std::vector<std::int64_t> out;
  long double time_s = 0;
  std::int64_t last_ns = 0;
  for (const double interval : intervals_s) {
    time_s += interval;
    const std::int64_t deadline_ns = std::llround(time_s * 1e9L);
    out.push_back(deadline_ns - last_ns);
    last_ns = deadline_ns;
  }
  return out;
}

/// One pass of coordinate descent over all intervals: changes an interval by 1 ns where this lowers
/// Sums::error(), the larger of the errors of mean and standard deviation. `error`: its value before the
/// pass; returns the value after the pass.
double descend(std::vector<std::int64_t>& intervals_ns, Sums& sums, double error, const FpsSetting& setting,
               FpsMean mean) {
  for (auto& interval : intervals_ns) {
    for (const int step : {-1, 1}) {
      Sums tried = sums;
      tried.add(interval, -1);
      tried.add(interval + step, 1);
      const double tried_error = tried.error(intervals_ns.size(), setting, mean);
      if (tried_error >= error) continue;
      interval += step;
      sums = tried;
      error = tried_error;
    }
    if (error <= bound) break;
  }
  return error;
}

/// Rounds intervals to nanoseconds. First rounds every deadline, so that rounding errors do not add up. Then
/// changes single intervals by 1 ns until the mean (relative) and the standard deviation (relative to max(sd,
/// 1 frame/s)) are met to 1e-6. With sd = 0, all intervals stay equal. base::Error naming the setting if no
/// such list is found.
std::vector<std::int64_t> whole_nanoseconds(const std::vector<double>& intervals_s, const FpsSetting& setting,
                                            FpsMean mean) {
  if (setting.sd == 0)
    return std::vector<std::int64_t>(intervals_s.size(), std::llround(intervals_s.front() * 1e9));
  auto intervals_ns = rounded_deadlines(intervals_s);
  Sums sums;
  for (const auto interval : intervals_ns) sums.add(interval, 1);
  double error = sums.error(intervals_ns.size(), setting, mean);
  for (int pass = 0; pass < 8 && error > bound; ++pass)
    error = descend(intervals_ns, sums, error, setting, mean);
  if (error > bound) {
    throw base::Error("setting " + setting_name(setting),
                      "its " + std::to_string(intervals_ns.size()) +
                          " frames, with intervals of whole nanoseconds, cannot meet its mean and sd to 1e-6",
                      "lengthen the trial");
  }
  return intervals_ns;
}

}  // namespace

PacingRules for_display(PacingRules rules, double refresh_hz) {
  if (rules.fps_max_is_refresh && refresh_hz > 0) rules.fps_max = refresh_hz;
  rules.fps_max_is_refresh = false;
  return rules;
}

bool FpsSetting::operator==(const FpsSetting& other) const {
  const bool profiles = profile && other.profile ? *profile == *other.profile : profile == other.profile;
  return mean == other.mean && sd == other.sd && duration_s == other.duration_s && profiles;
}

FpsSetting setting_of(const TimingProfile& profile, double duration_s) {
  FpsSetting out{profile.mean_fps, profile.sd_fps, duration_s,
                 std::make_shared<const TimingProfile>(profile)};
  if (!has_pattern(out)) return out;
  const stats::FpsMoments moments = stats::fps_moments(pattern_intervals(profile, duration_s, 0));
  out.mean = moments.mean;
  out.sd = moments.sd > 1e-9 ? moments.sd : 0;  // a smaller sd is a rounding error of equal intervals
  return out;
}

bool has_pattern(const FpsSetting& setting) {
  return setting.profile && setting.profile->kind != ProfileKind::Moments;
}

std::string setting_name(const FpsSetting& setting) {
  if (setting.profile) return profile_text(*setting.profile);
  return fmt::format("({:g}, {:g})", setting.mean, setting.sd);
}

std::int64_t frame_count(const FpsSetting& setting) {
  return std::max<std::int64_t>(1, std::llround(setting.mean * setting.duration_s));
}

Schedule compile_schedule(const FpsSetting& setting, const PacingRules& rules, std::uint64_t seed) {
  Schedule schedule;
  if (has_pattern(setting)) {
    schedule.intervals_s = pattern_intervals(*setting.profile, setting.duration_s, seed);
    schedule.intervals_ns = rounded_deadlines(schedule.intervals_s);
    return schedule;
  }
  for (const double rate : ordered(exact_rates(setting, rules), rules, seed))
    schedule.intervals_s.push_back(1 / rate);
  schedule.intervals_ns = whole_nanoseconds(schedule.intervals_s, setting, rules.mean);
  return schedule;
}

}  // namespace study
