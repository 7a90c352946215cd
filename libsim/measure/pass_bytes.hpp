#pragma once
/// The least bytes that the solver's passes move, and the time that memory needs for them.

#include <optional>
#include <span>
#include <string>

namespace measure {

/// A lower bound for one pass: each input read once, each output written once, for any method. Excludes data
/// that only some methods or particles use, cells and grids, so that a launch moves less from memory only if
/// a cache still holds the data.
struct PassBytes {
  const char* label;
  double a_particle;
  double a_neighbour;  ///< per entry of a neighbour list
  bool solved_only;    ///< covers only the particles that temporal acceleration solves
};
std::span<const PassBytes> pass_bytes();

/// The water during the launches: means over the frames.
struct PassWater {
  double particles = 0;
  double solved_share = 1;
  double listed = 0;  ///< neighbours per list; 0: unknown, and so are the bytes of passes that read lists
};

/// Bytes of one launch; none if the table has no such pass.
std::optional<double> least_bytes(const std::string& label, const PassWater& water);

struct PassFloor {
  double bytes_a_frame = 0;
  double ms_a_frame = 0;  ///< at the given bandwidth
  double times = 0;       ///< measured time over ms_a_frame
};
/// gb_s: bytes read plus written, 1e9 per second; above 0.
std::optional<PassFloor> floor_of(const std::string& label, double launches_a_frame, double ms_a_frame,
                                  const PassWater& water, double gb_s);

}  // namespace measure
