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
/// Highest frame rate that a protocol accepts in design.mean_fps, in frames/s. An interval of a frame rate
/// that ends above it is shown with "no upper bound".
inline constexpr double highest_rate = 1000;
/// Number of decimals for printing both ends of an interval: at least `decimals`, and more where a nonzero
/// end would be printed as 0. A reader can then see if the interval covers 0. Falls back to `decimals` if 8
/// decimals are not enough.
int interval_decimals(const std::array<double, 2>& interval, int decimals);
/// {"refused": reason}.
Json json_refused(const std::string& reason);
/// Replaces references to methods in a reason from stats by the methods' names: "method0" (counted from 0),
/// and "item 1" or "items 1, 3" (counted from 1).
std::string with_names(const std::string& reason, const std::vector<std::string>& methods);
/// Stars of significance: "***" for p below .001, "**" below .01, "*" below .05, else ""; "" if p is empty.
std::string json_stars(const std::optional<double>& p);

/// Index of `item` in `list`, from 0; the list's length if it is absent.
int place_in(const std::vector<std::string>& list, const std::string& item);

/// The value converted by `write`, or the refusal.
template <class T, class Write>
Json json_result(const stats::Result<T>& result, Write write) {
  return result ? Json(write(*result)) : json_refused(result.reason());
}

}  // namespace study
