#pragma once
/// Writes a sweep's results as one self-contained HTML page.

#include "libstudy/sweep/price_list.hpp"

namespace study {

/// The page: a work-precision diagram for each error, the settings on the Pareto fronts, the effect of each
/// knob, and all settings.
std::string accuracy_page(const PriceList& list, const SweepPlan& plan);

}  // namespace study
