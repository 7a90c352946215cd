#pragma once
/// The least bytes that passes of the solver move, and the time that memory takes for them.

#include <optional>
#include <span>
#include <string>

namespace apps {

/// One pass: each input read once, each output written once, whatever the method. What only some methods or
/// some particles read or write, cells and grids are left out, so that a launch never moves less from memory
/// unless a cache still holds it.
struct PassBytes {
  const char* label;
  double a_particle;
  double a_neighbour;  ///< of a list
  bool solved_only;    ///< goes over the particles that temporal acceleration solves, not over all
};
std::span<const PassBytes> pass_bytes();

/// The water that the launches met: means over the frames.
struct PassWater {
  double particles = 0;
  double solved_share = 1;
  double listed = 0;  ///< neighbours in a list; 0: not known, nor the bytes of a pass that reads lists
};

/// Bytes of one launch; none for a pass that is not in the table.
std::optional<double> least_bytes(const std::string& label, const PassWater& water);

struct PassFloor {
  double bytes_a_frame = 0;
  double ms_a_frame = 0;  ///< at the bandwidth
  double times = 0;       ///< measured time over this
};
/// gb_s: bytes read plus written, 1e9 a second; above 0.
std::optional<PassFloor> floor_of(const std::string& label, double launches_a_frame, double ms_a_frame,
                                  const PassWater& water, double gb_s);

}  // namespace apps
