#include "apps/stats/data/json_parts.hpp"

#include <cmath>

#include "stats/inference/adjust.hpp"

namespace apps {

Json json_number(double value) {
  if (std::isnan(value)) return {};
  if (std::isinf(value)) return value > 0 ? "Inf" : "-Inf";
  return value;
}

Json json_number(const std::optional<double>& value) { return value ? json_number(*value) : Json(); }

Json json_interval(const std::array<double, 2>& interval) {
  return Json::array({json_number(interval[0]), json_number(interval[1])});
}

Json json_interval(const std::optional<std::array<double, 2>>& interval) {
  return interval ? json_interval(*interval) : Json();
}

Json json_refused(const std::string& reason) { return {{"refused", reason}}; }

std::string json_stars(const std::optional<double>& p) { return p ? stats::stars(*p) : ""; }

}  // namespace apps
