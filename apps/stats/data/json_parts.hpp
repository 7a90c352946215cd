#pragma once
/// How numbers, intervals and refusals stand in the results (docs/results.md).

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "stats/base/json.hpp"
#include "stats/result.hpp"

namespace apps {

using Json = base::Json;

/// A finite number, "Inf" or "-Inf", or null when it is none.
Json json_number(double value);
Json json_number(const std::optional<double>& value);
Json json_interval(const std::array<double, 2>& interval);
Json json_interval(const std::optional<std::array<double, 2>>& interval);
/// The number that json_number() wrote; 0 for null.
double number_of(const Json& json);
/// Frames/s: no protocol has a higher rate (design.mean_fps), so an interval that ends beyond has no upper
/// bound.
inline constexpr double highest_rate = 1000;
/// Digits behind the point for both ends of an interval as text: `decimals`, or as many more as it takes that
/// no end looks like 0 that is not 0. So a reader sees whether the interval holds 0.
int interval_decimals(const std::array<double, 2>& interval, int decimals);
/// {"refused": reason}.
Json json_refused(const std::string& reason);
/// A reason in which methods go by their place, as stats has them ("method0, method2", "item 1", "items 1,
/// 3"), with their names.
std::string with_names(const std::string& reason, const std::vector<std::string>& methods);
/// "***", "**", "*" or ""; "" without p.
std::string json_stars(const std::optional<double>& p);

/// Where `item` stands in `list`, from 0; the list's length where it does not.
int place_in(const std::vector<std::string>& list, const std::string& item);

/// What `write` makes of the value, or the refusal.
template <class T, class Write>
Json json_result(const stats::Result<T>& result, Write write) {
  return result ? Json(write(*result)) : json_refused(result.reason());
}

}  // namespace apps
