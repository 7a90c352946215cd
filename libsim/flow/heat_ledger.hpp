#pragma once
/// Heat that entered and left the water.

#include <cmath>
#include <cstdint>

#include "libsim/exec/space.hpp"

namespace sim::SIM_BACKEND {

/// Since the run began, divided by the water's specific heat: mass in m_* times kelvin above the reference,
/// as integer multiples of `unit`, so that the order of the threads does not matter. Negative values in two's
/// complement.
struct HeatLedger {
  std::uint64_t poured;   ///< by nozzles
  std::uint64_t taken;    ///< for nozzles
  std::uint64_t drained;  ///< through outlets
  std::uint64_t walls;    ///< from walls with a given temperature

  static constexpr int unit_bits = 24;
  static constexpr double unit = 1.0 / (1 << unit_bits);
  SIM_FN static std::uint64_t of(float kelvin, int level) {
    const float units = kelvin * (static_cast<float>(1 << unit_bits) * static_cast<float>(1 << level));
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(rintf(units)));
  }
  static double amount(std::uint64_t entry) {
    return unit * static_cast<double>(static_cast<std::int64_t>(entry));
  }
};

}  // namespace sim::SIM_BACKEND
