#pragma once
/// Numbers, intervals and refusals as JSON values of the results (docs/report.md).

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "stats/base/json.hpp"
#include "stats/result.hpp"

namespace study {

using Json = base::Json;

/// A finite number, "Inf" or "-Inf"; null for NaN or an empty value.
Json json_number(double value);
Json json_number(const std::optional<double>& value);
Json json_interval(const std::array<double, 2>& interval);
Json json_interval(const std::optional<std::array<double, 2>>& interval);
/// Reads back the number that json_number() wrote; 0 for null.
double number_of(const Json& json);
/// In frames/s. No protocol has a higher rate (design.mean_fps), so an interval that ends beyond it has no
/// upper bound.
inline constexpr double highest_rate = 1000;
/// Decimals for printing both ends of an interval: `decimals`, or as many more as needed so that no nonzero
/// end is printed as 0. A reader then sees if the interval covers 0.
int interval_decimals(const std::array<double, 2>& interval, int decimals);
/// {"refused": reason}.
Json json_refused(const std::string& reason);
/// Replaces the numbers of methods in a reason from stats ("method0, method2", "item 1", "items 1, 3") by
/// their names.
std::string with_names(const std::string& reason, const std::vector<std::string>& methods);
/// "***", "**", "*" or ""; "" without p.
std::string json_stars(const std::optional<double>& p);

/// Index of `item` in `list`, from 0; the list's length if it is absent.
int place_in(const std::vector<std::string>& list, const std::string& item);

/// The value converted by `write`, or the refusal.
template <class T, class Write>
Json json_result(const stats::Result<T>& result, Write write) {
  return result ? Json(write(*result)) : json_refused(result.reason());
}

}  // namespace study
