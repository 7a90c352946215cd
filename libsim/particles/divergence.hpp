#pragma once
/// The first trouble of a run, found in the frame in which it happens.

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace sim {

/// In the order in which a substep can meet them.
enum class Trouble : std::uint8_t {
  NotFinite,          ///< a place or a velocity is NaN or infinite
  FarOutside,         ///< beyond a wall by ten times the tank's longest side
  TooFast,            ///< the guard on speed braked it
  NeighboursDropped,  ///< neighbours found no room in its list
  Coincident,         ///< another particle is at the same place
  TooDense            ///< denser than Divergence::most_density after the frame's last projection
};

/// What went wrong first, and how often anything did. A sound run has none.
struct Divergence {
  /// rho / rho_0 that no sound run reaches: a whole tank that splits at once may reach 1.25.
  static constexpr float most_density = 1.5f;

  int frame = 0;     ///< Simulation::frame() after it
  int particle = 0;  ///< id; the lowest where several met the same in the same pass
  Trouble cause{};
  /// At the frame's end, m. None: the place itself is not finite, or nobody has this id any more.
  std::optional<std::array<double, 3>> where_m;
  /// Cases up to now, as GuardCounts counts them, and one for each particle and frame that is too dense or
  /// not finite at the frame's end.
  std::uint64_t count = 0;
};

/// In words, such as "is not finite".
const char* in_words(Trouble cause);
/// "frame 12, particle 40 at (1.20, 0.31, 0.95) m is not finite; 3 cases so far".
std::string in_words(const Divergence& divergence);

}  // namespace sim
