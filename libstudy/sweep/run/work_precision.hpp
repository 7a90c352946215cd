#pragma once
/// A work-precision diagram: error over milliseconds, both logarithmic, one line per method.

#include <optional>

#include "libstudy/sweep/price_list.hpp"
#include "stats/figures/svg.hpp"

namespace study {

/// Each setting is a mark with its method's shape, with a stroke from its smallest to its largest seed. A
/// line joins the settings that no other of the method beats; a ring marks those that none of any method
/// beats. Settings without an error above 0 cannot be drawn and are left out; none if no setting is left.
std::optional<svg::Picture> work_precision(const PriceList& list, SweepError error);

}  // namespace study
