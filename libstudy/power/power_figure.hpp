#pragma once
/// Draws power over the number of participants from the JSON of power_json().

#include <string>

#include "libstudy/analysis/json_parts.hpp"

namespace study {

/// Returns an SVG picture. Task 1 and 2: a panel for each hypothesis with a line for each world. Pilot: a
/// panel for each of the curve's coefficients a and b, with the half widths of their intervals and their true
/// standard errors.
std::string power_svg(const Json& json);

}  // namespace study
