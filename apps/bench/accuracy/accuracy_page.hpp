#pragma once
/// What a sweep says as one HTML page that needs no other file.

#include "apps/common/sweep/price_list.hpp"

namespace apps {

/// A work-precision diagram for each error, the settings that none beats, the price list, all settings.
std::string accuracy_page(const PriceList& list, const SweepPlan& plan);

}  // namespace apps
