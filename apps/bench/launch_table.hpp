#pragma once
/// The solver's launches over many frames, each pass beside the least time that memory takes for it.

#include <map>
#include <string>
#include <vector>

#include "apps/bench/pass_bytes.hpp"
#include "libsim/exec/launch_time.hpp"
#include "stats/base/json.hpp"

namespace apps {

/// Launches of several stretches of a run, so that what is measured between them stays out.
class LaunchSums {
 public:
  void add(const std::vector<sim::LaunchTime>& stretch);
  /// Longest first.
  std::vector<sim::LaunchTime> all() const { return sim::longest_first(passes_); }

 private:
  std::map<std::string, sim::LaunchTime> passes_;
};

/// An array with pass, launches_a_frame, ms_a_frame, bytes_a_frame, floor_ms_a_frame and times_floor of each;
/// the last three are null where the table of pass_bytes.hpp has no row.
base::Json launches_json(const std::vector<sim::LaunchTime>& passes, int frames, const PassWater& water,
                         double gb_s);

/// The lines for it, and how fast memory is.
std::string launch_lines(const base::Json& launches, double gb_s);

}  // namespace apps
