#pragma once
/// Stateless random numbers: each depends only on its arguments, so that runs are reproducible whatever the
/// order and number of threads.

#include <cstdint>

#include "libsim/exec/space.hpp"

namespace sim::SIM_BACKEND {

/// A hash of 32 bits (lowbias32 by C. Wellons).
SIM_FN std::uint32_t mixed(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

/// 32 random bits from two numbers.
SIM_FN std::uint32_t random_bits(std::uint32_t a, std::uint32_t b) { return mixed(a * 0x9e3779b9u + b); }
/// 32 random bits from three numbers.
SIM_FN std::uint32_t random_bits(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return mixed(random_bits(a, b) + c * 0x85ebca6bu);
}

/// Uniform in [0, 1) from random bits.
SIM_FN float uniform_of(std::uint32_t bits) { return static_cast<float>(bits >> 8) * (1.0f / 16777216.0f); }

/// Uniform random number in [0, 1) for a particle id, a frame and a seed.
SIM_FN float activation_draw(std::uint32_t id, std::uint32_t frame, std::uint32_t seed) {
  const std::uint32_t words[3] = {seed, frame, id};
  std::uint32_t x = 0;
  for (int k = 0; k < 3; ++k) x = mixed((x ^ words[k]) + 0x9e3779b9u);
  return uniform_of(x);
}

}  // namespace sim::SIM_BACKEND
