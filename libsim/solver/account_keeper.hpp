#pragma once
/// The account of each frame (sim::FrameAccount): what the host knows already, and the few numbers that stand
/// in the back end's memory, brought over in one copy.

#include <bit>

#include "libsim/simulation.hpp"
#include "libsim/solver/stages/fluid_state.hpp"

namespace sim::SIM_BACKEND {

/// What is gathered over the particles.
struct Extremes {
  int fastest_bits;        ///< of the largest speed as a float, m/s: the order of floats >= 0
  std::uint64_t excess;    ///< max(rho / rho_0 - 1, 0) of the solved particles, times mass, as the last
                           ///< projection met it; in excess_unit
  std::uint64_t mass;      ///< of these, in m_*
  std::uint64_t troubled;  ///< particles that are not finite or too dense
  std::uint64_t first;     ///< of them, as a TroubleKey; 0 = none

  static constexpr float excess_unit = 1.0f / (1 << 20);
  /// Mean over the water.
  double compression() const {
    return mass ? static_cast<double>(excess_unit) * static_cast<double>(excess) / static_cast<double>(mass)
                : 0;
  }
  float fastest() const { return std::bit_cast<float>(fastest_bits); }
};

/// What is brought over.
struct FrameTally {
  Guards guards;              ///< since the run began
  NeighbourList::Need lists;  ///< of the last substep
  int active;                 ///< particles that the frame solved
  Extremes extremes;
  int by_level[LevelSupports::most];  ///< particles
};

/// What the guards met since the run began.
GuardCounts guard_counts(const Guards& met, const FluidState& state);

class AccountKeeper {
 public:
  /// Who is there before the first frame; levels that particles can have: finest .. coarsest.
  void begin(const std::vector<ParticleState>& start, int finest_level, int coarsest_level);
  /// After run_frame, which leaves the particles in the grid's order: level by level. `went_by`: temporal
  /// acceleration, whose number of active particles is filled in; none where the method has none. `frame`:
  /// Simulation::frame() after it.
  FrameTally take(const FluidState& state, std::optional<TemporalReport> went_by, int frame);
  const FrameAccount& account() const { return account_; }
  /// What take() has found since begin().
  const std::optional<Divergence>& divergence() const { return divergence_; }
  /// What outlives a frame (libsim/solver/state_archive.hpp).
  template <class Archive>
  void keep(Archive& archive) {
    archive(finest_level_, coarsest_level_, account_.particles_by_level, account_.temporal, account_.guards,
            met_, divergence_);
  }

 private:
  int finest_level_ = 0, coarsest_level_ = 0;
  FrameAccount account_;
  /// Adds what a frame met, and says who was the first of the run.
  void look_for_trouble(const FluidState& state, const FrameTally& tally, int frame);

  GuardCounts met_;  ///< up to the last frame
  std::optional<Divergence> divergence_;
  Array<FrameTally> tally_;
  Array<Extremes> extremes_;
};

}  // namespace sim::SIM_BACKEND
