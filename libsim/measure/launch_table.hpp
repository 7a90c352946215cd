#pragma once
/// The solver's launches over many frames, each pass compared with the least time its memory traffic takes.

#include <map>
#include <string>
#include <vector>

#include "libsim/exec/launch_time.hpp"
#include "libsim/measure/pass_bytes.hpp"
#include "stats/base/json.hpp"

namespace measure {

/// Sums the launches of several parts of a run, so that measurements between them are left out.
class LaunchSums {
 public:
  void add(const std::vector<sim::LaunchTime>& stretch);
  /// Longest first.
  std::vector<sim::LaunchTime> all() const { return sim::longest_first(passes_); }

 private:
  std::map<std::string, sim::LaunchTime> passes_;
};

/// An array with pass, launches_a_frame, ms_a_frame, bytes_a_frame, floor_ms_a_frame and times_floor of each
/// pass; the last three are null if pass_bytes() has no row for it.
base::Json launches_json(const std::vector<sim::LaunchTime>& passes, int frames, const PassWater& water,
                         double gb_s);

/// The array as printable lines, with the memory's bandwidth.
std::string launch_lines(const base::Json& launches, double gb_s);

}  // namespace measure
