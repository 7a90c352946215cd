#pragma once
/// The execution layer: the only place that knows a back end. This header and every kernel that includes it
/// are compiled by g++ into sim::cpu (SIM_BACKEND=cpu, OpenMP) and by nvcc into sim::cuda (SIM_BACKEND=cuda),
/// from one text. Kernels are trivially copyable functors `void operator()(int i) const`; all work is in
/// order on one stream.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "libsim/exec/launch_timer.hpp"

#ifdef SIM_CUDA
#include <cuda_runtime.h>
#define SIM_FN __host__ __device__ __forceinline__
#else
#define SIM_FN inline
#endif

namespace sim::SIM_BACKEND {

/// Memory of the back end. Errors (out of memory, device lost) are base::Error.
void* allocate(std::size_t bytes);
void release(void* pointer) noexcept;
void copy_to_host(void* host, const void* device, std::size_t bytes);
void copy_from_host(void* device, const void* host, std::size_t bytes);
void copy_within(void* to, const void* from, std::size_t bytes);
void fill_zero(void* device, std::size_t bytes);
/// Returns when all launched work is done; throws what it failed with.
void synchronize();

/// A column of trivially copyable values in the back end's memory. Movable only.
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

  /// Sets the size; contents are undefined when it grows beyond the capacity.
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
  /// Makes room for later sizes; contents are undefined when it grows.
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

/// The last value, read back from the back end; 0 when there is none.
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

/// sums[i] = values[0] + ... + values[i].
class Scanner {
 public:
  void inclusive_sum(const Array<int>& values, Array<int>& sums);

 private:
  Array<unsigned char> scratch_;
};

/// A functor of for_each_team is given the lanes that share its index: lane k takes a loop's steps k, k +
/// size, ... and the parts are summed. Here it is one, and everything folds away.
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
  /// The lanes' value that comes before all others by T::before, which tells all but equal values apart.
  template <class T>
  SIM_FN T first(T value) const {
    return value;
  }
  /// The sum over the lanes before this one, and over all.
  SIM_FN int offset(int mine, int& all) const {
    all = mine;
    return 0;
  }
  /// What any lane has written is there for all.
  SIM_FN void wait() const {}
};

#ifdef SIM_CUDA

void check(cudaError_t status, const char* what);
/// Do launches take their places before the one before them has ended?
bool launches_overlap();
/// Lanes that should share each of n indices, measured on an H200 with the solver's passes over neighbours.
int team_wish(int n);

/// Launches `kernel` behind what was launched before. Where the device can, its blocks take their places
/// while the last ones before it end, and wait there: begin_kernel() is the first that each kernel does.
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

template <class F>
__global__ void __launch_bounds__(256) run_kernel(int n, const __grid_constant__ F f) {
  begin_kernel();
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < n) f(i);
}

/// f(0) ... f(n-1) in any order; nothing when n is 0. `label` names the pass in errors and profiles.
template <class F>
void for_each(const char* label, int n, F f) {
  static_assert(std::is_trivially_copyable_v<F>);
  if (n <= 0) return;
  const LaunchTimer timer(label);
  launch(label, run_kernel<F>, static_cast<unsigned>((n + 255) / 256), 256, 0, n, f);
}

/// Lanes of a warp; the size is a power of two above one. The host only names the type.
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
  /// The value of the lane whose rank differs in the bit `step`, word by word.
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

/// a / b to about one unit in the last place, for b up to 2^126.
SIM_FN float quotient(float a, float b) {
#ifdef __CUDA_ARCH__
  return __fdividef(a, b);
#else
  return a / b;
#endif
}
SIM_FN float reciprocal(float x) { return quotient(1, x); }

/// sqrt(x), the same.
SIM_FN float rough_root(float x) {
#ifdef __CUDA_ARCH__
  float root;
  asm("sqrt.approx.ftz.f32 %0, %1;" : "=f"(root) : "f"(x));
  return root;
#else
  return sqrtf(x);
#endif
}

/// A distance r > 0 from its square, and quotients by it: on the GPU both come from one reciprocal root.
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

template <int Size, class F>
__global__ void __launch_bounds__(256) run_team_kernel(int n, const __grid_constant__ F f) {
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
  const auto blocks = (static_cast<long long>(n) * Size + 255) / 256;
  launch(label, run_team_kernel<Size, F>, static_cast<unsigned>(blocks), 256, 0, n, f);
}

/// f(i, lanes) for i = 0 ... n-1 in any order, for functors with a loop inside: the fewer indices there are,
/// the more lanes share each, so that the device stays full.
template <class F>
void for_each_team(const char* label, int n, F f) {
  static_assert(std::is_trivially_copyable_v<F>);
  if (n <= 0) return;
  const LaunchTimer timer(label);
  switch (team_wish(n)) {
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

/// *target += amount; gives what it was.
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

#else

/// Indices that a thread takes at once: enough to hide what taking costs, and several turns for each thread,
/// so that none waits long for the others.
int grain_of(int n);

/// f(0) ... f(n-1) in any order; nothing when n is 0. `label` names the pass in errors and profiles.
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

inline float quotient(float a, float b) { return a / b; }
inline float reciprocal(float x) { return 1 / x; }
inline float rough_root(float x) { return std::sqrt(x); }

/// A distance r > 0 from its square, and quotients by it.
struct Root {
  float r;
  explicit Root(float square) : r(std::sqrt(square)) {}
  float under(float value) const { return value / r; }
};

template <class F>
struct OnOneLane {
  F f;
  void operator()(int i) const { f(i, OneLane{}); }
};

/// f(i, lanes) for i = 0 ... n-1 in any order, for functors with a long loop inside, which a device may share
/// between lanes.
template <class F>
void for_each_team(const char* label, int n, F f) {
  for_each(label, n, OnOneLane<F>{f});
}

template <class T>
void atomic_add(T* target, T value) {
#pragma omp atomic
  *target += value;
}

/// *target += amount; gives what it was.
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

template <class T>
void atomic_max(T* target, T value) {
#pragma omp critical(sim_atomic_max)
  if (value > *target) *target = value;
}

#endif

/// Sums values[0..n-1] in double over fixed chunks, so that the result does not depend on the number of
/// threads.
double fixed_order_sum(const Array<float>& values, int n);
/// Largest value; 0 when n is 0.
float maximum(const Array<float>& values, int n);

}  // namespace sim::SIM_BACKEND
