#pragma once
/// Heat that came and went.

#include <cmath>
#include <cstdint>

#include "libsim/exec/space.hpp"

namespace sim::SIM_BACKEND {

/// Since the run began, over the water's specific heat: mass in m_* times kelvin above the reference, in
/// whole numbers of `unit`, so that the order of the threads does not matter. Below 0 in two's complement.
struct HeatLedger {
  std::uint64_t poured;   ///< by nozzles
  std::uint64_t taken;    ///< for nozzles
  std::uint64_t drained;  ///< through outlets
  std::uint64_t walls;    ///< from walls of a temperature of their own

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
