#pragma once
/// Diffuse particles - spray, foam and bubbles - in a pool of their own (Ihmsen et al. 2012). Water moves
/// them; they do not move the water.

#include <cstdint>

#include "libsim/exec/space.hpp"
#include "libsim/exec/vec.hpp"
#include "libsim/foam/meeting.hpp"

namespace sim::SIM_BACKEND {

/// What became of all that was emitted since the run began: emitted = alive + dissolved + dropped + left.
struct FoamLedger {
  std::uint64_t emitted;    ///< that the potentials asked for
  std::uint64_t dissolved;  ///< at the end of their time on the water
  std::uint64_t dropped;    ///< that found no room in the pool
  std::uint64_t left;       ///< through an outlet, or no longer finite
};

/// Diffuse particles as programs count them. They are told apart by the water round them: its density there
/// over rho_0, as if water stood behind the walls. A count of neighbours would depend on the levels.
struct FoamKinds {
  static constexpr float spray = 0.2f;    ///< with less it flies
  static constexpr float bubble = 0.75f;  ///< with more it rises
};

struct FoamPool {
  /// x, y, z in m; w: seconds that it has left on the water, 0 or less where the place is free.
  Array<Vec4> place;
  Array<Vec4> velocity;  ///< m/s; w: water round it, as in FoamKinds
  Array<FoamLedger> ledger;
  std::uint32_t frame = 0;  ///< a counter of the random numbers

  // Scratch of one frame; lives on to keep its memory.
  MeetingCells cells;
  Array<float> approach;     ///< of each water particle, 1/s
  Array<int> births, sums;   ///< of each water particle, and inclusive sums
  Array<int> free, free_of;  ///< 1 = the place is free, and inclusive sums
  Scanner scanner;

  /// Room for `most` diffuse particles beside `water` of water; nobody is there.
  void begin(int most, int water);
  /// 0 without foam.
  int capacity() const { return static_cast<int>(place.size()); }
  std::size_t bytes() const {
    return place.bytes() + velocity.bytes() + ledger.bytes() + approach.bytes() + births.bytes() +
           sums.bytes() + free.bytes() + free_of.bytes() + cells.bytes();
  }
  /// What outlives a frame (libsim/solver/state_archive.hpp).
  template <class Archive>
  void keep(Archive& archive) {
    const std::size_t most = place.size();
    archive(place, velocity, ledger, frame);
    if constexpr (Archive::reads) {
      if (place.size() != most || velocity.size() != most || ledger.size() != 1)
        Archive::fail("holds a pool of foam of another size");
    }
  }
};

}  // namespace sim::SIM_BACKEND
