#pragma once
/// The first numerical trouble of a run, detected in the frame in which it occurs.

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace sim {

/// Kinds of trouble of a particle, in the order in which a substep detects them.
enum class Trouble : std::uint8_t {
  NotFinite,          ///< position or velocity is NaN or infinite
  FarOutside,         ///< beyond a wall by more than ten times the tank's longest side
  TooFast,            ///< slowed by the speed limit
  NeighboursDropped,  ///< some of its neighbours were dropped, because the memory for lists was full
  Coincident,         ///< closer to another particle than 1e-5 of the pair's support
  TooDense            ///< denser than Divergence::most_density after the frame's last projection
};

/// The first trouble of a run, and the number of cases. A run without trouble has no Divergence.
struct Divergence {
  /// rho / rho_0 that no sound run exceeds: a tank in which all particles split at once may reach 1.25.
  static constexpr float most_density = 1.5f;

  int frame = 0;     ///< Simulation::frame() at the end of the frame in which the trouble occurred
  int particle = 0;  ///< id; the lowest if several had the same trouble in the same pass
  Trouble cause{};
  /// Position at the frame's end, m. None if it is not finite, or the particle no longer exists.
  std::optional<std::array<double, 3>> where_m;
  /// Cases so far: not_finite, speed_limited, neighbours_dropped and coincident_pairs of GuardCounts, plus
  /// one per frame for each particle that is too dense or not finite at the frame's end.
  std::uint64_t count = 0;
};

/// Text for messages, such as "is not finite".
const char* in_words(Trouble cause);
/// Text for messages, such as "frame 12, particle 40 at (1.200, 0.310, 0.950) m is not finite; 3 cases so
/// far".
std::string in_words(const Divergence& divergence);

}  // namespace sim
