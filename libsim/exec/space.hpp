#pragma once
/// The execution layer: memory, launches, sorts and sums, with one interface for both back ends. This header
/// and every kernel that includes it are compiled by g++ into sim::cpu (SIM_BACKEND=cpu, OpenMP) and by nvcc
/// into sim::cuda (SIM_BACKEND=cuda), from the same source. Kernels are trivially copyable functors `void
/// operator()(int i) const`; all work runs in order on one stream.

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "libsim/exec/function.hpp"
#include "libsim/exec/launch_time.hpp"

namespace sim::SIM_BACKEND {

/// Switches the profile of this back end (number and total time of the launches with each label) on or off,
/// and discards earlier measurements.
void profile_launches(bool on);
/// The profile: one entry per label, longest first; waits for all launched work.
std::vector<LaunchTime> launch_times();

/// Timer around each launch; off unless a bench switches it on.
class LaunchTimer {
 public:
  explicit LaunchTimer(const char* label) {
    if (on) begin(label);
  }
  ~LaunchTimer() {
    if (on) end();
  }
  LaunchTimer(const LaunchTimer&) = delete;
  LaunchTimer& operator=(const LaunchTimer&) = delete;

 private:
  friend void profile_launches(bool);
  static void begin(const char* label);
  static void end();
  static bool on;
};

/// Memory of the back end. Errors (out of memory, device lost): base::Error on a GPU, std::bad_alloc on the
/// CPU.
void* allocate(std::size_t bytes);
void release(void* pointer) noexcept;
void copy_to_host(void* host, const void* device, std::size_t bytes);
void copy_from_host(void* device, const void* host, std::size_t bytes);
void copy_within(void* to, const void* from, std::size_t bytes);
void fill_zero(void* device, std::size_t bytes);
/// Waits until all launched work is done; throws its errors.
void synchronize();

/// An array of trivially copyable values in the back end's memory. Movable only.
template <class T>
class Array {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Array() = default;
  explicit Array(std::size_t size) { resize(size); }
  Array(Array&& other) noexcept { swap(other); }
  Array& operator=(Array&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Array() { release(data_); }

  /// Sets the size; contents are undefined if it grows beyond the capacity.
  void resize(std::size_t size) {
    if (size > capacity_) {
      release(data_);
      data_ = nullptr;
      capacity_ = 0;
      data_ = static_cast<T*>(allocate(size * sizeof(T)));
      capacity_ = size;
    }
    size_ = size;
  }
  /// Allocates memory for later sizes; contents are undefined if the memory grows.
  void reserve(std::size_t capacity) {
    const std::size_t size = size_;
    if (capacity > capacity_) resize(capacity);
    size_ = size;
  }
  void swap(Array& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }
  T* data() { return data_; }
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  std::size_t bytes() const { return capacity_ * sizeof(T); }
  void zero() { fill_zero(data_, size_ * sizeof(T)); }

  std::vector<T> to_host() const {
    std::vector<T> out(size_);
    copy_to_host(out.data(), data_, size_ * sizeof(T));
    return out;
  }
  void from_host(const std::vector<T>& values) {
    resize(values.size());
    copy_from_host(data_, values.data(), values.size() * sizeof(T));
  }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

/// The last value, read back from the back end; 0 if empty.
template <class T>
T last_of(const Array<T>& values) {
  T out = 0;
  if (values.size()) copy_to_host(&out, values.data() + (values.size() - 1), sizeof out);
  return out;
}

/// Sorts the pairs (keys[i], order[i]) by key, stably; `order` is any payload, often 0..n-1.
class Sorter {
 public:
  void sort(Array<std::uint64_t>& keys, Array<int>& order);

 private:
  Array<std::uint64_t> keys_;
  Array<int> order_;
  Array<unsigned char> scratch_;
};

class Scanner {
 public:
  /// sums[i] = values[0] + ... + values[i]; both may be the same array.
  void inclusive_sum(const Array<int>& values, Array<int>& sums);
  /// counts[i] = number of flags[0] ... flags[i] that are not 0; n entries.
  void inclusive_count(const std::uint8_t* flags, int n, Array<int>& counts);

 private:
  Array<unsigned char> scratch_;
};

#ifdef SIM_CUDA

void check(cudaError_t status, const char* what);
/// True if the blocks of a launch can start before the previous launch has ended.
bool launches_overlap();
/// Number of lanes that should share each of n indices: the fastest number for the solver's passes over
/// neighbours, as measured on an H200.
int team_wish(int n);
/// The same for density and displacement: with particles of several levels half as many, at least one.
inline int team_wish_of_projections(int n, bool one_level) {
  const int wish = team_wish(n);
  return one_level || wish == 1 ? wish : wish / 2;
}

/// Launches `kernel` after the previous launch. If the device supports it, the kernel's blocks start while
/// the last blocks of the previous launch end. They wait in begin_kernel(), which each kernel must call
/// first.
template <class... Parameters, class... Arguments>
void launch(const char* label, void (*kernel)(Parameters...), unsigned blocks, unsigned threads,
            std::size_t shared_bytes, Arguments... arguments) {
  cudaLaunchAttribute overlap{};
  overlap.id = cudaLaunchAttributeProgrammaticStreamSerialization;
  overlap.val.programmaticStreamSerializationAllowed = 1;
  cudaLaunchConfig_t config{};
  config.gridDim = dim3(blocks);
  config.blockDim = dim3(threads);
  config.dynamicSmemBytes = shared_bytes;
  config.attrs = &overlap;
  config.numAttrs = launches_overlap() ? 1 : 0;
  check(cudaLaunchKernelEx(&config, kernel, Parameters(arguments)...), label);
}
__device__ __forceinline__ void begin_kernel() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  cudaGridDependencySynchronize();
  cudaTriggerProgrammaticLaunchCompletion();
#endif
}

/// Threads per block, except in one_block.hpp.
constexpr int block_threads = 256;

template <class F>
__global__ void __launch_bounds__(block_threads) run_kernel(int n, const __grid_constant__ F f) {
  begin_kernel();
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < n) f(i);
}

/// Calls f(0) ... f(n-1) in any order; does nothing if n is 0. `label` names the pass in errors and profiles.
template <class F>
void for_each(const char* label, int n, F f) {
  static_assert(std::is_trivially_copyable_v<F>);
  if (n <= 0) return;
  const LaunchTimer timer(label);
  launch(label, run_kernel<F>, static_cast<unsigned>((n + block_threads - 1) / block_threads), block_threads,
         0, n, f);
}

/// Number of lanes per index for n indices: f.lanes(n) if the functor defines `int lanes(int n) const`,
/// otherwise team_wish(n).
template <class F>
int lanes_for(const F& f, int n) {
  if constexpr (requires { f.lanes(n); }) {
    return f.lanes(n);
  } else {
    return team_wish(n);
  }
}

/// Minimum number of blocks that a multiprocessor must be able to run at once. Without this number the
/// compiler uses so few registers that a thread waits for each load separately. Passes over neighbours gain
/// more from overlapping loads than from more blocks.
constexpr int least_team_blocks = 4;

template <int Size, class F>
__global__ void __launch_bounds__(block_threads, least_team_blocks)
    run_team_kernel(int n, const __grid_constant__ F f) {
  begin_kernel();
  const int i = static_cast<int>((blockIdx.x * blockDim.x + threadIdx.x) / Size);
  if (i >= n) return;
  if constexpr (Size == 1) {
    f(i, OneLane{});
  } else {
    f(i, Lanes<Size>{});
  }
}

template <int Size, class F>
void launch_teams(const char* label, int n, F f) {
  const auto blocks = (static_cast<long long>(n) * Size + block_threads - 1) / block_threads;
  launch(label, run_team_kernel<Size, F>, static_cast<unsigned>(blocks), block_threads, 0, n, f);
}

/// Calls f(i, lanes) for i = 0 ... n-1 in any order, for functors with an inner loop: the fewer indices, the
/// more lanes share each, so that the device stays fully used.
template <class F>
void for_each_team(const char* label, int n, F f) {
  static_assert(std::is_trivially_copyable_v<F>);
  if (n <= 0) return;
  const LaunchTimer timer(label);
  switch (lanes_for(f, n)) {
    case 8:
      return launch_teams<8>(label, n, f);
    case 4:
      return launch_teams<4>(label, n, f);
    case 2:
      return launch_teams<2>(label, n, f);
    default:
      return launch_teams<1>(label, n, f);
  }
}

#else

/// Size of the chunks in which OpenMP hands indices to threads: large enough to hide the cost of handing out,
/// and small enough that each thread gets several chunks of a long loop, which balances the load.
int grain_of(int n);

/// Calls f(0) ... f(n-1) in any order; does nothing if n is 0. `label` names the pass in errors and profiles.
template <class F>
void for_each(const char* label, int n, F f) {
  static_assert(std::is_trivially_copyable_v<F>);
  if (n <= 0) return;
  const LaunchTimer timer(label);
  if (n < 512) {
    for (int i = 0; i < n; ++i) f(i);
    return;
  }
  const int grain = grain_of(n);
#pragma omp parallel for schedule(dynamic, grain)
  for (int i = 0; i < n; ++i) f(i);
}

template <class F>
struct OnOneLane {
  F f;
  void operator()(int i) const { f(i, OneLane{}); }
};

/// Calls f(i, lanes) for i = 0 ... n-1 in any order, for functors with a long inner loop, which a device may
/// divide among lanes.
template <class F>
void for_each_team(const char* label, int n, F f) {
  for_each(label, n, OnOneLane<F>{f});
}

#endif

/// Sums values[0..n-1] in double over fixed chunks, so that the result does not depend on the number of
/// threads.
double fixed_order_sum(const Array<float>& values, int n);
/// Largest of values[0..n-1], which must all be >= 0; 0 if n is 0.
float maximum(const Array<float>& values, int n);

}  // namespace sim::SIM_BACKEND
