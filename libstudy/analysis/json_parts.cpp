#include "libstudy/analysis/json_parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stats/base/pattern.hpp"
#include "stats/inference/adjust.hpp"

namespace study {

Json json_number(double value) {
  if (std::isnan(value)) return {};
  if (std::isinf(value)) return value > 0 ? "Inf" : "-Inf";
  return value;
}

Json json_number(const std::optional<double>& value) { return value ? json_number(*value) : Json(); }

double number_of(const Json& json) {
  if (json == "Inf" || json == "-Inf")
    return (json == "Inf" ? 1 : -1) * std::numeric_limits<double>::infinity();
  return json.is_number() ? json.get<double>() : 0;
}

Json json_interval(const std::array<double, 2>& interval) {
  return Json::array({json_number(interval[0]), json_number(interval[1])});
}

Json json_interval(const std::optional<std::array<double, 2>>& interval) {
  return interval ? json_interval(*interval) : Json();
}

int interval_decimals(const std::array<double, 2>& interval, int decimals) {
  constexpr int most = 8;  // a nonzero end below 0.5e-8 is a rounding error of 0
  const auto looks_like_0 = [](double end, int digits) {
    return end != 0 && std::abs(end) <= 0.5 * std::pow(10.0, -digits);
  };
  for (int digits = decimals; digits <= most; ++digits)
    if (!looks_like_0(interval[0], digits) && !looks_like_0(interval[1], digits)) return digits;
  return decimals;
}

Json json_refused(const std::string& reason) { return {{"refused", reason}}; }

std::string with_names(const std::string& reason, const std::vector<std::string>& methods) {
  static const base::Pattern column("\\bmethod([0-9]{1,4})\\b"),
      items("\\bitems? ([0-9]{1,4}((, | and )[0-9]{1,4})*)"), item("([0-9]{1,4})");
  const auto named = [&](const std::string& text, const base::Pattern& place, std::size_t first) {
    return place.replaced(text, [&](const base::Groups& found) {
      return methods.at(static_cast<std::size_t>(std::stoi(found[1])) - first);
    });
  };
  return items.replaced(named(reason, column, 0),
                        [&](const base::Groups& found) { return named(found[1], item, 1); });
}

std::string json_stars(const std::optional<double>& p) { return p ? stats::stars(*p) : ""; }

int place_in(const std::vector<std::string>& list, const std::string& item) {
  return static_cast<int>(std::find(list.begin(), list.end(), item) - list.begin());
}

}  // namespace study
