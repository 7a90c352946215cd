#pragma once
/// Power over the number of participants, drawn from the JSON of power_json().

#include <string>

#include "libstudy/analysis/json_parts.hpp"

namespace study {

/// Task 1 and 2: a panel for each hypothesis with a line for each world; pilot: half widths of a and b.
std::string power_svg(const Json& json);

}  // namespace study
