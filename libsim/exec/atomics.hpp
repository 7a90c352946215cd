#pragma once
/// Atomic additions and maxima on one memory location.

#include <cstdint>

#include "libsim/exec/function.hpp"

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

/// *target += amount; returns the old value.
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

/// A unique number: the count of earlier calls. The threads of a warp share one atomic operation.
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

/// Sets a flag that other threads may set too.
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

/// *target += amount; returns the old value.
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

/// A unique number: the count of earlier calls.
inline int atomic_next(int* target) { return atomic_take(target, 1); }

template <class T>
void atomic_max(T* target, T value) {
#pragma omp critical(sim_atomic_max)
  if (value > *target) *target = value;
}

/// Sets a flag that other threads may set too.
inline void atomic_raise(int* flag) {
#pragma omp atomic write
  *flag = 1;
}

#endif

}  // namespace sim::SIM_BACKEND
