#pragma once
/// The account of each frame (sim::FrameAccount): values that the host already has, and a few numbers from
/// the back end's memory, read in one copy.

#include <bit>

#include "libsim/simulation.hpp"
#include "libsim/solver/stages/fluid_state.hpp"

namespace sim::SIM_BACKEND {

/// Sums and maxima over the particles.
struct Extremes {
  /// bit pattern of the largest speed as a float, m/s. An integer maximum of bit patterns finds it, because
  /// the patterns of floats >= 0 have the same order as the floats.
  int fastest_bits;
  /// sum over the solved particles of mass times (rho / rho_0 - 1), the bracket limited to 0 .. 1, with rho
  /// of the last projection; in units of excess_unit times m_*, the mass of a particle of level 0
  std::uint64_t excess;
  std::uint64_t mass;  ///< mass of the solved particles, in m_*
  /// number of particles whose velocity is not finite, plus the number of solved particles that are too dense
  std::uint64_t troubled;
  std::uint64_t first;  ///< the first troubled particle, as a TroubleKey; 0 = none

  static constexpr float excess_unit = 1.0f / (1 << 20);
  /// Mean excess over the solved water.
  double compression() const {
    return mass ? static_cast<double>(excess_unit) * static_cast<double>(excess) / static_cast<double>(mass)
                : 0;
  }
  float fastest() const { return std::bit_cast<float>(fastest_bits); }
};

/// The numbers that are copied to the host once per frame.
struct FrameTally {
  Guards guards;              ///< guard counts since the run began
  NeighbourList::Need lists;  ///< space that long neighbour lists requested, see NeighbourList::Need
  int active;                 ///< particles solved in the frame
  Extremes extremes;
  int by_level[LevelSupports::most];  ///< number of particles of each level
};

/// Guard counts since the run began.
GuardCounts guard_counts(const Guards& met, const FluidState& state);

class AccountKeeper {
 public:
  /// Starts the account with the particles before the first frame; their levels lie in finest .. coarsest.
  void begin(const std::vector<ParticleState>& start, int finest_level, int coarsest_level);
  /// Reads the account of the frame that run_frame just computed; particles must still be sorted by level, as
  /// run_frame leaves them. `went_by`: report of temporal acceleration, to which take() adds the number of
  /// active particles; none for other methods. `frame`: Simulation::frame() after this frame.
  FrameTally take(const FluidState& state, std::optional<TemporalReport> went_by, int frame);
  const FrameAccount& account() const { return account_; }
  /// The first trouble that take() has found since begin(), if any.
  const std::optional<Divergence>& divergence() const { return divergence_; }
  /// Writes or reads the state that lasts beyond a frame (libsim/solver/state_archive.hpp).
  template <class Archive>
  void keep(Archive& archive) {
    archive(finest_level_, coarsest_level_, account_.particles_by_level, account_.temporal, account_.guards,
            met_, divergence_);
  }

 private:
  int finest_level_ = 0, coarsest_level_ = 0;
  FrameAccount account_;
  /// Adds the frame's trouble counts, and records the first troubled particle of the run.
  void look_for_trouble(const FluidState& state, const FrameTally& tally, int frame);

  GuardCounts met_;  ///< guard counts up to the last frame
  std::optional<Divergence> divergence_;
  Array<FrameTally> tally_;
  Array<Extremes> extremes_;
};

}  // namespace sim::SIM_BACKEND
