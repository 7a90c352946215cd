#pragma once
/// A sweep's results as one self-contained HTML page.

#include "libstudy/sweep/price_list.hpp"

namespace study {

/// A work-precision diagram per error, the settings that no other one beats, the price list, all settings.
std::string accuracy_page(const PriceList& list, const SweepPlan& plan);

}  // namespace study
