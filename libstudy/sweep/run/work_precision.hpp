#pragma once
/// Draws a work-precision diagram: error over time per frame in ms, on logarithmic axes, with one line for
/// each method.

#include <optional>

#include "libstudy/sweep/price_list.hpp"
#include "stats/figures/svg.hpp"

namespace study {

/// Each setting is a mark with its method's shape; a stroke extends from the smallest to the largest error of
/// its seeds. A line joins the settings on the Pareto front of the method. A ring marks settings on the
/// Pareto front of all methods. Settings with a mean error or time of 0 are left out. Empty if no setting is
/// left.
std::optional<svg::Picture> work_precision(const PriceList& list, SweepError error);

}  // namespace study
