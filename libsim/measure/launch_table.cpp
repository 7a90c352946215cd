#include "libsim/measure/launch_table.hpp"

#include <fmt/format.h>

#include "stats/base/json.hpp"

namespace measure {

void LaunchSums::add(const std::vector<sim::LaunchTime>& stretch) {
  for (const auto& pass : stretch) {
    passes_[pass.label].launches += pass.launches;
    passes_[pass.label].ms += pass.ms;
  }
}

base::Json launches_json(const std::vector<sim::LaunchTime>& passes, int frames, const PassWater& water,
                         double gb_s) {
  base::Json out = base::Json::array();
  for (const auto& pass : passes) {
    const double launches = static_cast<double>(pass.launches) / frames, ms = pass.ms / frames;
    const auto least = floor_of(pass.label, launches, ms, water, gb_s);
    const auto or_none = [&](double value) { return least ? base::Json(value) : base::Json(); };
    const PassFloor floor = least.value_or(PassFloor{});
    out.push_back({{"pass", pass.label},
                   {"launches_a_frame", launches},
                   {"ms_a_frame", ms},
                   {"bytes_a_frame", or_none(floor.bytes_a_frame)},
                   {"floor_ms_a_frame", or_none(floor.ms_a_frame)},
                   {"times_floor", or_none(floor.times)}});
  }
  return out;
}

std::string launch_lines(const base::Json& launches, double gb_s) {
  std::string out = fmt::format("  bandwidth    {:8.1f} GB/s of a copy in memory, read plus written\n", gb_s);
  out += fmt::format("  {:<32} {:>10} {:>8} {:>10} {:>10} {:>11}\n", "pass", "ms a frame", "launches",
                     "least MB", "floor ms", "times floor");
  const auto cell = [](const base::Json& value, double scale, int digits) {
    return value.is_null() ? std::string("-") : fmt::format("{:.{}f}", value.get<double>() * scale, digits);
  };
  for (const auto& pass : launches) {
    out += fmt::format("  {:<32} {:>10} {:>8} {:>10} {:>10} {:>11}\n", pass["pass"].get<std::string>(),
                       cell(pass["ms_a_frame"], 1, 4), cell(pass["launches_a_frame"], 1, 1),
                       cell(pass["bytes_a_frame"], 1e-6, 2), cell(pass["floor_ms_a_frame"], 1, 4),
                       cell(pass["times_floor"], 1, 2));
  }
  return out;
}

}  // namespace measure
