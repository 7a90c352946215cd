#pragma once
/// The execution layer: the only place that knows a back end. This header and every kernel that includes it
/// are compiled by g++ into sim::cpu (SIM_BACKEND=cpu, OpenMP) and by nvcc into sim::cuda (SIM_BACKEND=cuda),
/// from one text. Kernels are trivially copyable functors `void operator()(int i) const`; all work is in
/// order on one stream.

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

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

#ifdef SIM_CUDA

void check(cudaError_t status, const char* what);

template <class F>
__global__ void __launch_bounds__(256) run_kernel(int n, F f) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < n) f(i);
}

/// f(0) ... f(n-1) in any order; nothing when n is 0. `label` names the pass in errors and profiles.
template <class F>
void for_each(const char* label, int n, F f) {
  static_assert(std::is_trivially_copyable_v<F>);
  if (n <= 0) return;
  run_kernel<<<(n + 255) / 256, 256>>>(n, f);
  check(cudaGetLastError(), label);
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

SIM_FN void atomic_max(int* target, int value) {
#ifdef __CUDA_ARCH__
  atomicMax(target, value);
#else
  if (value > *target) *target = value;
#endif
}

#else

/// f(0) ... f(n-1) in any order; nothing when n is 0. `label` names the pass in errors and profiles.
template <class F>
void for_each([[maybe_unused]] const char* label, int n, F f) {
  static_assert(std::is_trivially_copyable_v<F>);
  if (n < 512) {
    for (int i = 0; i < n; ++i) f(i);
    return;
  }
#pragma omp parallel for schedule(dynamic, 512)
  for (int i = 0; i < n; ++i) f(i);
}

template <class T>
void atomic_add(T* target, T value) {
#pragma omp atomic
  *target += value;
}

inline void atomic_max(int* target, int value) {
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
