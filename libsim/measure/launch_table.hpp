#pragma once
/// The solver's launches over many frames, each pass compared with the least time its memory traffic takes.

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libsim/exec/launch_time.hpp"
#include "stats/base/json.hpp"

namespace measure {

/// A lower bound for one pass: each input read once, each output written once, for any method. Excludes
/// cells, grids, and data that only some methods or particles use. A launch can move fewer bytes from memory
/// only if a cache still holds data.
struct PassBytes {
  const char* label;
  double a_particle;   ///< bytes per particle
  double a_neighbour;  ///< bytes per entry of a neighbour list
  bool solved_only;    ///< covers only the particles that temporal acceleration solves
};
std::span<const PassBytes> pass_bytes();

/// The water during the launches: means over the frames.
struct PassWater {
  double particles = 0;
  double solved_share = 1;
  double listed = 0;  ///< neighbours per list; 0: unknown, which makes the bytes of passes with lists unknown
};

/// Least bytes of one launch; none if the table has no such pass, or if the pass reads lists and
/// PassWater::listed is unknown.
std::optional<double> least_bytes(const std::string& label, const PassWater& water);

struct PassFloor {
  double bytes_a_frame = 0;
  double ms_a_frame = 0;  ///< at the given bandwidth
  double times = 0;       ///< measured time / ms_a_frame
};
/// The least time of a pass at the memory's bandwidth gb_s, reads plus writes, 1e9 bytes per second, above 0.
/// None if least_bytes() gives none, or without launches.
std::optional<PassFloor> floor_of(const std::string& label, double launches_a_frame, double ms_a_frame,
                                  const PassWater& water, double gb_s);

/// Adds up the launches of several parts of a run. Between the parts a bench measures the water's accuracy;
/// the launches of these measurements are left out.
class LaunchSums {
 public:
  void add(const std::vector<sim::LaunchTime>& stretch);
  /// The sums of each pass; the pass with the longest time comes first.
  std::vector<sim::LaunchTime> all() const { return sim::longest_first(passes_); }

 private:
  std::map<std::string, sim::LaunchTime> passes_;
};

/// An array with pass, launches_a_frame, ms_a_frame, bytes_a_frame, floor_ms_a_frame and times_floor of each
/// pass; the last three are null if floor_of() gives none.
base::Json launches_json(const std::vector<sim::LaunchTime>& passes, int frames, const PassWater& water,
                         double gb_s);

/// The array as printable lines, with the memory's bandwidth.
std::string launch_lines(const base::Json& launches, double gb_s);

}  // namespace measure
