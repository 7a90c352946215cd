#pragma once
/// A work-precision diagram: error over milliseconds, both logarithmic, a line a method.

#include <optional>

#include "apps/common/svg.hpp"
#include "apps/common/sweep/price_list.hpp"

namespace apps {

/// Each setting is a mark of its method's shape, with a stroke from its least seed to its largest; a line
/// joins those that no other of the method beats, a ring marks those that none of any method beats. What has
/// no error cannot be drawn on the axis and is left out; none where nothing is left.
std::optional<svg::Picture> work_precision(const PriceList& list, SweepError error);

}  // namespace apps
