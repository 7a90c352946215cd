#pragma once
/// The console output of vip-stats power.

#include "libstudy/power/power_json.hpp"

namespace apps {

/// Prints the request and the results for up to six numbers of participants on stdout.
void print_power(const study::PowerRequest& request, const study::Json& json);

}  // namespace apps
