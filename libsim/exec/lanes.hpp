#pragma once
/// The lanes that share one index of for_each_team.

#include <cstring>
#include <type_traits>

#include "libsim/exec/function.hpp"

namespace sim::SIM_BACKEND {

/// A functor of for_each_team gets the lanes that share its index: lane k processes a loop's steps k, k +
/// size, ... and the partial results are summed. Here there is one lane, and everything is optimised away.
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
  /// The smallest of the lanes' values by T::before, which must order all unequal values.
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
