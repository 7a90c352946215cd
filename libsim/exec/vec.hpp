#pragma once
/// Small vectors for kernels. Each back end has them in its own namespace, because g++ and nvcc compile these
/// functions differently: of two inline functions with the same name the linker keeps only one.

#include <cmath>

#include "libsim/exec/space.hpp"

namespace sim::SIM_BACKEND {

struct Vec3 {
  float x, y, z;
};

/// Memory layout of a particle's position: one aligned 16-byte load.
struct alignas(16) Vec4 {
  float x, y, z, w;
};

/// at_least: max(a, b); at_most: min(a, b). The bound b must not be NaN; if a is NaN, the result is b, as
/// with fmaxf and fminf. On the CPU, fmaxf and fminf are function calls and would prevent vectorisation.
SIM_FN float at_least(float a, float b) {
#ifdef __CUDA_ARCH__
  return fmaxf(a, b);
#else
  return a > b ? a : b;
#endif
}
SIM_FN float at_most(float a, float b) {
#ifdef __CUDA_ARCH__
  return fminf(a, b);
#else
  return a < b ? a : b;
#endif
}
/// floor(x), clamped to low .. high.
SIM_FN int floor_within(float x, int low, int high) {
#ifdef __CUDA_ARCH__
  return min(max(__float2int_rd(x), low), high);
#else
  return static_cast<int>(at_most(at_least(floorf(x), static_cast<float>(low)), static_cast<float>(high)));
#endif
}

SIM_FN Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
SIM_FN Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
SIM_FN Vec3 operator*(float s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
SIM_FN Vec3& operator+=(Vec3& a, Vec3 b) {
  a = a + b;
  return a;
}
SIM_FN float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
/// a + s b with one rounding, identical in every kernel that computes it.
SIM_FN Vec3 fused(Vec3 a, float s, Vec3 b) {
  return {fmaf(s, b.x, a.x), fmaf(s, b.y, a.y), fmaf(s, b.z, a.z)};
}
SIM_FN float length(Vec3 a) { return sqrtf(dot(a, a)); }
SIM_FN Vec3 xyz(Vec4 a) { return {a.x, a.y, a.z}; }
SIM_FN Vec4 with_w(Vec3 a, float w) { return {a.x, a.y, a.z, w}; }
SIM_FN bool all_finite(Vec3 a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

}  // namespace sim::SIM_BACKEND
