#pragma once
/// The two levels of a light sensor or trigger line, and the instants at which it changes between them.

#include <span>
#include <string>
#include <vector>

#include "libstudy/light/sensor_log.hpp"

namespace study {

/// Dark and bright level in the units of the log, and the spread of the samples about them.
struct LightLevels {
  double low = 0, high = 0, noise = 0;
};

/// Finds the two levels: the medians of two clusters (2-means). noise: 1.4826 times the median absolute
/// deviation. outliers: share of the samples at either end that the clusters do not begin with; 0 for a
/// trigger line, which is seldom up. base::Error at `place`, which names `what`, if the levels are not six
/// times the noise apart.
LightLevels find_levels(std::span<const float> samples, const std::string& place, const std::string& what,
                        double outliers = 0.001);

struct LightEdge {
  double time_s = 0;
  bool rise = false;  ///< true: from dark to bright
};

/// The changes between the levels, alternately up and down, in order of time. A change counts once the
/// samples have passed 65 % of the way; its time is the last crossing of the middle before, linear between
/// samples; in a log of events, the time of the row. A dark gap or, at the same place, a pulse that does not
/// pass 35 % is no change. hold_s: dark gaps shorter than this are bridged (displays that light up in
/// pulses).
std::vector<LightEdge> find_edges(const SensorLog& log, std::span<const float> samples,
                                  const LightLevels& levels, double hold_s);

}  // namespace study
