#pragma once
/// Functions that kernels call on both back ends: atomic operations, fast quotients and roots, and the lanes
/// of a team.

#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

/// SIM_FN: prefix of functions that kernels call. SIM_FN_APART: the same for rarely used functions, which are
/// not inlined.
#ifdef SIM_CUDA
#include <cuda_runtime.h>
#define SIM_FN __host__ __device__ __forceinline__
#define SIM_FN_APART __host__ __device__ __noinline__
#else
#define SIM_FN inline
#define SIM_FN_APART [[gnu::noinline]] inline
#endif

namespace sim::SIM_BACKEND {

#ifdef SIM_CUDA

template <class T>
SIM_FN void atomic_add(T* target, T value) {
#ifdef __CUDA_ARCH__
  atomicAdd(target, value);
#else
  *target += value;
#endif
}

SIM_FN void atomic_add(std::uint64_t* target, std::uint64_t value) {
#ifdef __CUDA_ARCH__
  atomicAdd(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(value));
#else
  *target += value;
#endif
}

/// Atomically adds `amount` to *target, and returns the old value.
SIM_FN std::uint64_t atomic_take(std::uint64_t* target, std::uint64_t amount) {
#ifdef __CUDA_ARCH__
  return atomicAdd(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(amount));
#else
  const std::uint64_t was = *target;
  *target += amount;
  return was;
#endif
}

SIM_FN int atomic_take(int* target, int amount) {
#ifdef __CUDA_ARCH__
  return atomicAdd(target, amount);
#else
  const int was = *target;
  *target += amount;
  return was;
#endif
}

/// Atomically adds 1 to *target, and returns the old value: each call gets a different number. The threads of
/// a warp share one atomic operation.
SIM_FN int atomic_next(int* target) {
#ifdef __CUDA_ARCH__
  const unsigned together = __match_any_sync(__activemask(), reinterpret_cast<unsigned long long>(target));
  const unsigned before = together & ((1u << (threadIdx.x & 31u)) - 1);
  const int leader = __ffs(static_cast<int>(together)) - 1;
  int first = 0;
  if (before == 0) first = atomicAdd(target, __popc(together));
  return __shfl_sync(together, first, leader) + __popc(before);
#else
  return atomic_take(target, 1);
#endif
}

SIM_FN void atomic_max(int* target, int value) {
#ifdef __CUDA_ARCH__
  atomicMax(target, value);
#else
  if (value > *target) *target = value;
#endif
}

SIM_FN void atomic_max(std::uint64_t* target, std::uint64_t value) {
#ifdef __CUDA_ARCH__
  atomicMax(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(value));
#else
  if (value > *target) *target = value;
#endif
}

/// Sets *flag to 1; several threads may set the same flag at the same time.
SIM_FN void atomic_raise(int* flag) {
#ifdef __CUDA_ARCH__
  volatile int* const seen = flag;
  if (*seen == 0) *seen = 1;
#else
  *flag = 1;
#endif
}

#else

template <class T>
void atomic_add(T* target, T value) {
#pragma omp atomic
  *target += value;
}

/// Atomically adds `amount` to *target, and returns the old value.
template <class T>
T atomic_take(T* target, T amount) {
  T was;
#pragma omp atomic capture
  {
    was = *target;
    *target += amount;
  }
  return was;
}

/// Atomically adds 1 to *target, and returns the old value: each call gets a different number.
inline int atomic_next(int* target) { return atomic_take(target, 1); }

template <class T>
void atomic_max(T* target, T value) {
#pragma omp critical(sim_atomic_max)
  if (value > *target) *target = value;
}

/// Sets *flag to 1; several threads may set the same flag at the same time.
inline void atomic_raise(int* flag) {
#pragma omp atomic write
  *flag = 1;
}

#endif

// Fast quotients and roots for loops over neighbours: on the GPU accurate to some units in the last place.

/// a / b, on the GPU with an error of at most two units in the last place, for |b| from 2^-126 to 2^126.
SIM_FN float quotient(float a, float b) {
#ifdef __CUDA_ARCH__
  float inverse;  // one instruction; __fdividef also checks the range of b
  asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(b));
  return a * inverse;
#else
  return a / b;
#endif
}
SIM_FN float reciprocal(float x) { return quotient(1, x); }

/// sqrt(x), on the GPU with an error of about one unit in the last place.
SIM_FN float rough_root(float x) {
#ifdef __CUDA_ARCH__
  float root;
  asm("sqrt.approx.ftz.f32 %0, %1;" : "=f"(root) : "f"(x));
  return root;
#else
  return sqrtf(x);
#endif
}

/// The root r of `square`, which must be > 0, and quotients under(value) = value / r. On the GPU the
/// root and the quotients are computed from one approximate reciprocal root.
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

/// The lanes that share one index in for_each_team. Lane k processes the steps k, k + size, ... of a
/// functor's inner loop; sum() combines the partial results. OneLane is the case of a single lane: the
/// compiler removes all calls.
struct OneLane {
  static constexpr int size = 1;
  SIM_FN int rank() const { return 0; }
  template <class T>
  SIM_FN T sum(T value) const {
    return value;
  }
  template <class T>
  SIM_FN T min(T value) const {
    return value;
  }
  SIM_FN bool any(bool mine) const { return mine; }
  /// The lanes' value that comes first in the order of T::before, which must order all unequal values.
  template <class T>
  SIM_FN T first(T value) const {
    return value;
  }
  /// The sum over the lanes before this one; `all` gets the sum over all lanes.
  SIM_FN int offset(int mine, int& all) const {
    all = mine;
    return 0;
  }
  /// Makes writes of any lane visible to all.
  SIM_FN void wait() const {}
};

#ifdef SIM_CUDA
/// Lanes of a warp; the size is a power of two above one. On the host only the type is used.
#ifdef __CUDA_ARCH__
template <int Size>
struct Lanes {
  static constexpr int size = Size;
  __device__ int rank() const { return static_cast<int>(threadIdx.x) & (Size - 1); }
  template <class T>
  __device__ T sum(T value) const {
#pragma unroll
    for (int step = Size / 2; step > 0; step /= 2) value += __shfl_xor_sync(mask(), value, step, Size);
    return value;
  }
  template <class T>
  __device__ T min(T value) const {
#pragma unroll
    for (int step = Size / 2; step > 0; step /= 2) {
      const T other = __shfl_xor_sync(mask(), value, step, Size);
      value = other < value ? other : value;
    }
    return value;
  }
  __device__ bool any(bool mine) const { return __any_sync(mask(), mine); }
  template <class T>
  __device__ T first(T value) const {
#pragma unroll
    for (int step = Size / 2; step > 0; step /= 2) {
      const T other = across(value, step);
      if (other.before(value)) value = other;
    }
    return value;
  }
  __device__ int offset(int mine, int& all) const {
    int sum = mine;
#pragma unroll
    for (int step = 1; step < Size; step *= 2) {
      const int lower = __shfl_up_sync(mask(), sum, step, Size);
      if (rank() >= step) sum += lower;
    }
    all = __shfl_sync(mask(), sum, Size - 1, Size);
    return sum - mine;
  }
  __device__ void wait() const { __syncwarp(mask()); }

 private:
  /// The value of the lane whose rank differs in the bit `step`, copied word by word.
  template <class T>
  __device__ T across(T value, int step) const {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(unsigned) == 0);
    unsigned words[sizeof(T) / sizeof(unsigned)];
    memcpy(words, &value, sizeof value);
#pragma unroll
    for (unsigned& word : words) word = __shfl_xor_sync(mask(), word, step, Size);
    memcpy(&value, words, sizeof value);
    return value;
  }

  static constexpr unsigned whole = (1u << Size) - 1;
  __device__ unsigned first() const { return threadIdx.x & 31u & ~static_cast<unsigned>(Size - 1); }
  __device__ unsigned mask() const { return whole << first(); }
};
#else
template <int Size>
struct Lanes : OneLane {};
#endif
#endif

}  // namespace sim::SIM_BACKEND
