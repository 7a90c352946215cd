#pragma once
/// The clock of a light sensor against the clock of a session.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/light/light_edges.hpp"

namespace study {

/// The sensor's time of a record's time t, s: offset + scale t, and for dark onsets `shift` more.
struct ClockMapping {
  double offset = 0, scale = 1, shift = 0;
  double at(double t, bool rise) const { return offset + scale * t + (rise ? 0 : shift); }
};

/// For each showing the recorded onsets of its frames, s, ascending, at least two.
using OnsetTimes = std::vector<std::vector<double>>;

struct ClockAlignment {
  ClockMapping mapping;
  /// Showings whose onsets have edges there, and showings that would lie wholly in the log.
  std::int64_t agreeing = 0, inside = 0;
};

/// Finds the mapping for which most onsets have an edge. The first onsets of a showing vote for the offset,
/// for drifts up to 0.5 %; the other showings follow in order of their distance. The mapping is fitted
/// robustly (Tukey's biweight) to the edges within 8 ms of an onset. None if no showing agrees: fewer than 60
/// % of its onsets have an edge.
std::optional<ClockAlignment> align_clocks(const SensorLog& log, std::span<const LightEdge> edges,
                                           const OnsetTimes& onsets_s);

/// The first and the last instant of a showing on the sensor's clock, s.
std::pair<double, double> span_of_showing(const std::vector<double>& onsets_s, const ClockMapping& mapping);
/// Why the log cannot judge a showing, such as a gap in it; empty: it can.
std::string why_unjudged(const std::vector<double>& onsets_s, const ClockMapping& mapping,
                         const SensorLog& log);

double light_median(std::vector<double> values);
/// Median absolute value, scaled to the standard deviation of a normal distribution.
double light_spread(std::vector<double> values);
/// Mean of the values within four spreads of their median.
double trimmed_light_mean(const std::vector<double>& values);

}  // namespace study
