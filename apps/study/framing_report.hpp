#pragma once
/// What `vip-study check` tells of how a display frames the scenes: as text and as JSON.

#include <nlohmann/json_fwd.hpp>

#include "apps/study/check_report.hpp"

namespace apps {

void print_framing(const CheckReport& report);
void add_framing(nlohmann::ordered_json& json, const CheckReport& report);

}  // namespace apps
