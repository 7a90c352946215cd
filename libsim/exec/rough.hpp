#pragma once
/// Fast quotients and roots for loops over neighbours: on the GPU accurate to some units in the last place.

#include <cmath>

#include "libsim/exec/function.hpp"

namespace sim::SIM_BACKEND {

/// a / b to about one unit in the last place, for b up to 2^126.
SIM_FN float quotient(float a, float b) {
#ifdef __CUDA_ARCH__
  return __fdividef(a, b);
#else
  return a / b;
#endif
}
SIM_FN float reciprocal(float x) { return quotient(1, x); }

/// sqrt(x), with the same accuracy.
SIM_FN float rough_root(float x) {
#ifdef __CUDA_ARCH__
  float root;
  asm("sqrt.approx.ftz.f32 %0, %1;" : "=f"(root) : "f"(x));
  return root;
#else
  return sqrtf(x);
#endif
}

/// A distance r > 0 from its square, and divisions by it: on the GPU both use one reciprocal root.
struct Root {
#ifdef __CUDA_ARCH__
  float r, inverse;
  __device__ explicit Root(float square) {
    asm("rsqrt.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(square));
    r = square * inverse;
  }
  __device__ float under(float value) const { return value * inverse; }
#else
  float r;
  SIM_FN explicit Root(float square) : r(sqrtf(square)) {}
  SIM_FN float under(float value) const { return value / r; }
#endif
};

}  // namespace sim::SIM_BACKEND
