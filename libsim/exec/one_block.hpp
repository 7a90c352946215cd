#pragma once
/// Runs many small passes in one launch: a block of threads that synchronise between the passes.

#include "libsim/exec/space.hpp"

namespace sim::SIM_BACKEND {

/// The indices that one thread processes: first, first + stride, ... below end.
struct Walk {
  int first, stride, end;

  template <class F>
  SIM_FN void each(F f) const {
    for (int i = first; i < end; i += stride) f(i);
  }
  /// Sum of f(i), in a fixed order.
  template <class F>
  SIM_FN float sum(F f) const {
    float out = 0;
    for (int i = first; i < end; i += stride) out += f(i);
    return out;
  }
  /// The smallest f(i) below `most`, and its first index; otherwise `most` and `end`.
  template <class F>
  SIM_FN float least(float most, int& where, F f) const {
    where = end;
    for (int i = first; i < end; i += stride) {
      const float it = f(i);
      if (it < most) {
        most = it;
        where = i;
      }
    }
    return most;
  }
};

#ifdef SIM_CUDA

/// The first warp of a block of threads. Kernels call its functions; the host only needs them to compile.
struct OneWarp {
  template <class F>
  SIM_FN void each(int n, F f) const {
    walk(n).each(f);
#ifdef __CUDA_ARCH__
    __syncwarp();
#endif
  }
  /// f(0) + ... + f(n-1), bit-identical for all lanes and in each run. All lanes must call it together, with
  /// the same n. f may read values written by the preceding each().
  template <class F>
  SIM_FN float sum(int n, F f) const {
    float out = walk(n).sum(f);
#ifdef __CUDA_ARCH__
    for (int far = 16; far > 0; far /= 2) out += __shfl_xor_sync(0xffffffffu, out, far);
#endif
    return out;
  }
  /// The smallest f(i) below `most`, and its first index, the same for all lanes; otherwise `most` and n. As
  /// for sum(), all lanes must call it together, with the same n and `most`.
  template <class F>
  SIM_FN float least(int n, float most, int& where, F f) const {
    float out = walk(n).least(most, where, f);
#ifdef __CUDA_ARCH__
    for (int far = 16; far > 0; far /= 2) {
      const float other = __shfl_xor_sync(0xffffffffu, out, far);
      const int there = __shfl_xor_sync(0xffffffffu, where, far);
      const bool better = other < out || (other == out && there < where);
      out = better ? other : out;
      where = better ? there : where;
    }
#endif
    return out;
  }

 private:
  SIM_FN static Walk walk(int n) {
#ifdef __CUDA_ARCH__
    return {static_cast<int>(threadIdx.x), 32, n};
#else
    return {0, 1, n};
#endif
  }
};

/// The threads of one block, which can synchronise.
struct OneBlock {
  static constexpr int most = 1024;
  /// Calls f(i) once for each i = 0 ... n-1, spread over the block's threads. All threads must call each()
  /// together. All calls of f have finished on return.
  template <class F>
  SIM_FN void each(int n, F f) const {
    spread(n, f);
    wait();
  }
  /// Like each(), but the calls of f may finish only during the block's next wait().
  template <class F>
  SIM_FN void spread(int n, F f) const {
#ifdef __CUDA_ARCH__
    for (int i = static_cast<int>(threadIdx.x); i < n; i += static_cast<int>(blockDim.x)) f(i);
#else
    for (int i = 0; i < n; ++i) f(i);
#endif
  }
  SIM_FN void wait() const {
#ifdef __CUDA_ARCH__
    __syncthreads();
#endif
  }
  /// Calls f(warp) in the block's first warp; the other threads wait until it has returned. warp.each()
  /// synchronises only this warp, which is faster for steps over few indices.
  template <class F>
  SIM_FN void by_one_warp(F f) const {
#ifdef __CUDA_ARCH__
    if (threadIdx.x < 32) f(OneWarp{});
#else
    f(OneWarp{});
#endif
    wait();
  }
};

/// Largest shared memory of a block, bytes.
std::size_t most_block_memory();

template <bool Beside, class F>
__global__ void __launch_bounds__(OneBlock::most)
    run_block_kernel(const __grid_constant__ F f, unsigned char* spare) {
  begin_kernel();
  extern __shared__ uint4 beside[];
  f(OneBlock{}, Beside ? reinterpret_cast<unsigned char*>(beside) : spare);
}

/// Each thread of one block calls f(block, room): for a sequence of passes over so few cells that one launch
/// per pass would take longer than the passes. `width`: largest number of indices of a pass. `room`: `bytes`
/// of scratch memory, in shared memory if that is large enough, otherwise in `spare`.
template <class F>
void in_one_block(const char* label, int width, std::size_t bytes, Array<unsigned char>& spare, F f) {
  static_assert(std::is_trivially_copyable_v<F>);
  const LaunchTimer timer(label);
  const int threads = width < OneBlock::most ? (width + 31) / 32 * 32 : OneBlock::most;
  if (bytes <= most_block_memory()) {
    const auto kernel = run_block_kernel<true, F>;
    check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, static_cast<int>(bytes)),
          label);
    launch(label, kernel, 1, static_cast<unsigned>(threads), bytes, f, nullptr);
  } else {
    spare.resize(bytes);
    launch(label, run_block_kernel<false, F>, 1, static_cast<unsigned>(threads), 0, f, spare.data());
  }
}
/// Grids of at most this many cells should be processed in one block (in_one_block()).
constexpr int one_block_cells = 8192;

#else

struct OneBlock {
  /// Calls f(0) ... f(n-1) in order: on the CPU a block has one thread.
  template <class F>
  void each(int n, F f) const {
    for (int i = 0; i < n; ++i) f(i);
  }
  /// Same as each(); on the GPU the calls of f may finish only during the next wait().
  template <class F>
  void spread(int n, F f) const {
    each(n, f);
  }
  void wait() const {}
  /// f(0) + ... + f(n-1), in a fixed order.
  template <class F>
  float sum(int n, F f) const {
    return Walk{0, 1, n}.sum(f);
  }
  /// The smallest f(i) below `most`, and its first index; otherwise `most` and n.
  template <class F>
  float least(int n, float most, int& where, F f) const {
    return Walk{0, 1, n}.least(most, where, f);
  }
  /// Calls f with this block, whose functions are those of the GPU's OneWarp.
  template <class F>
  void by_one_warp(F f) const {
    f(*this);
  }
};

/// Calls f(block, room) once, for a sequence of passes over few cells. `room`: `bytes` of scratch memory.
template <class F>
void in_one_block(const char* label, int /*width*/, std::size_t bytes, Array<unsigned char>& spare, F f) {
  const LaunchTimer timer(label);
  spare.resize(bytes);
  f(OneBlock{}, spare.data());
}
/// Grids of at most this many cells should be processed in one block (in_one_block()).
constexpr int one_block_cells = 512;

#endif

}  // namespace sim::SIM_BACKEND
