#pragma once
/// Selects the particles that a pass solves, before the launch: all, or the active ones of temporal
/// acceleration (ViP-Fluid, Algorithm 3). A pass runs over slots 0 .. n-1; the selection gives the particle
/// of each slot.

#include <cstdint>

#include "libsim/exec/space.hpp"

namespace sim::SIM_BACKEND {

/// Selects all particles: the slot is the particle's index. The compiler removes the calls of these
/// functions.
struct AllParticles {
  static constexpr bool everyone = true;
  /// The k-th slot that a pass must process; -1 = none.
  SIM_FN int slot(int k) const { return k; }
  SIM_FN int operator()(int slot) const { return slot; }
  SIM_FN float moves(int) const { return 1; }
};

/// The first slots contain the indices of the active particles, in the grid's order. The remaining slots
/// contain ~i, a negative number, for each inactive particle i. So almost every warp has either only active
/// or only inactive particles.
struct ActiveParticles {
  static constexpr bool everyone = false;
  const int* slots;
  const std::uint8_t* active;
  bool others_pressed;  ///< gravity and the coarse pressure also move the unsolved particles
  SIM_FN int slot(int k) const { return k; }
  SIM_FN int operator()(int slot) const { return slots[slot]; }
  /// 1 for a solved particle, otherwise 0.
  SIM_FN float moves(int i) const { return active[i] ? 1.0f : 0.0f; }
  /// 1 if gravity moves the particle, otherwise 0.
  SIM_FN float falls(int i) const { return others_pressed || active[i] ? 1.0f : 0.0f; }
};

/// Number of substeps since each particle was last solved, in a substep that solves all: 2 for particles that
/// rested in the substep before.
struct TimeOfRest {
  const std::uint8_t* active = nullptr;  ///< nullptr: no particle rested
  SIM_FN float operator()(int i) const { return active && !active[i] ? 2.0f : 1.0f; }
};

/// Selects all particles, active or not, in the order of the slots of ActiveParticles.
struct EverySlot {
  static constexpr bool everyone = true;
  const int* slots;
  SIM_FN int slot(int k) const { return k; }
  SIM_FN int operator()(int slot) const {
    const int i = slots[slot];
    return i < 0 ? ~i : i;
  }
  SIM_FN float moves(int) const { return 1; }
};

/// A short list of particles of another selection, made by an earlier pass, in any order.
template <class Selection>
struct Listed {
  static constexpr bool everyone = false;
  Selection select;
  const int* slots;
  const int* count;
  SIM_FN int slot(int k) const { return k < *count ? slots[k] : -1; }
  SIM_FN int operator()(int slot) const { return slot < 0 ? -1 : select(slot); }
};

/// True if a pass processes only a short list; profiles use it to separate such passes.
template <class Selection>
inline constexpr bool few_in = false;
template <class Selection>
inline constexpr bool few_in<Listed<Selection>> = true;

}  // namespace sim::SIM_BACKEND
