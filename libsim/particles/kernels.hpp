#pragma once
/// Smoothing kernels of the solver: density by poly6, gradients by spiky (Mueller et al. 2003;
/// Macklin and Mueller 2013), evaluated once per pair with hbar = (h_i + h_j) / 2 so that W_ij = W_ji and
/// pair terms cancel exactly.

#include <cstdint>

#include "libsim/exec/vec.hpp"
#include "libsim/particles/random.hpp"

namespace sim::SIM_BACKEND {

inline constexpr float pi = 3.14159265358979f;
/// rho / rho_0 of the cubic lattice with h = 2 d under the usual poly6: 103950 / (32768 pi). The kernels are
/// divided by it, so that the lattice has exactly the rest density.
inline constexpr float lattice_density = 103950.0f / (32768.0f * pi);
/// Pairs closer than this share of h count as coincident.
inline constexpr float coincident = 1e-5f;
/// Pairs closer than this share of h are pushed apart even where the density asks for nothing. Two particles
/// of too low a density do not push each other, so that their neighbours would press them into one place.
inline constexpr float too_close = 1e-3f;

/// Kernels for one support radius.
struct Kernel {
  float h, h2, poly6, spiky;

  SIM_FN explicit Kernel(float support_radius) : Kernel(support_radius, 1 / support_radius) {}
  /// From h and 1 / h. All powers of 1 / h are products of this quotient, because divisions are slow.
  SIM_FN Kernel(float support_radius, float inverse) : h(support_radius), h2(h * h) {
    const float inverse3 = inverse * inverse * inverse;
    spiky = 45 / (pi * lattice_density) * (inverse3 * inverse3);
    poly6 = 315 / (64 * pi * lattice_density) * (inverse3 * inverse3 * inverse3);
  }

  /// W(r) in 1/m3; r2 = r^2 in m2.
  SIM_FN float density(float r2) const {
    const float t = at_least(h2 - r2, 0.0f);
    return poly6 * t * t * t;
  }
  /// -dW/dr in 1/m4; grad_i W = -slope (x_i - x_j) / r.
  SIM_FN float slope(float r) const {
    const float t = at_least(h - r, 0.0f);
    return spiky * t * t;
  }
};

/// The kernel of a pair of particles: from one support if all particles have the same level, otherwise from
/// the mean of both supports.
template <bool OneLevel>
struct PairKernel;

template <>
struct PairKernel<true> {
  Kernel kernel;
  SIM_FN explicit PairKernel(float h_self) : kernel(h_self) {}
  SIM_FN Kernel with(float) const { return kernel; }
  SIM_FN float mass_ratio(float) const { return 1; }
};

template <>
struct PairKernel<false> {
  float h_self, inverse_cube;
  SIM_FN explicit PairKernel(float h) : h_self(h), inverse_cube(1 / (h * h * h)) {}
  SIM_FN Kernel with(float h_other) const {
    const float h = 0.5f * (h_self + h_other);
    return {h, reciprocal(h)};
  }
  /// m_j / m_i
  SIM_FN float mass_ratio(float h_other) const { return h_other * h_other * h_other * inverse_cube; }
};

/// Mass of a particle of support h: rho_0 d^3 with spacing d = h / 2.
SIM_FN float mass_of(float h, float rest_density) { return rest_density * 0.125f * h * h * h; }

/// A unit vector for two coincident particles; swapping them flips its sign.
SIM_FN Vec3 parting_direction(int id_i, int id_j) {
  const bool swapped = id_i > id_j;
  const auto a = static_cast<std::uint32_t>(swapped ? id_j : id_i);
  const auto b = static_cast<std::uint32_t>(swapped ? id_i : id_j);
  const std::uint32_t x = random_bits(a, b);
  const float y = static_cast<float>(x & 0xffff) / 32768.0f - 1;
  const float angle = static_cast<float>(x >> 16) * (2 * pi / 65536.0f);
  const float across = sqrtf(at_least(1 - y * y, 0.0f));
  const float sign = swapped ? -1.0f : 1.0f;
  return {sign * across * cosf(angle), sign * y, sign * across * sinf(angle)};
}

/// Before a loop over neighbours: runs it in SIMD lanes on the CPU and sums the named variables. The loop
/// body must be one call; constructing structs in it prevents vectorisation. On the GPU a thread loads four
/// neighbours at a time, so that their loads overlap.
#ifdef SIM_CUDA
#define SIM_LANES(...) _Pragma("unroll 4")
#else
#define SIM_LANES_TEXT(text) _Pragma(#text)
#define SIM_LANES(...) SIM_LANES_TEXT(omp simd reduction(+ : __VA_ARGS__))
#endif

}  // namespace sim::SIM_BACKEND
