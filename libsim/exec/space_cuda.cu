// CUB's headers take seconds to compile: only this file includes them, for sort, scan and sums.
#include <cub/cub.cuh>
#include <thrust/iterator/transform_iterator.h>

#include <deque>
#include <map>

#include "libsim/exec/one_block.hpp"
#include "stats/base/error.hpp"

namespace sim::SIM_BACKEND {

void check(cudaError_t status, const char* what) {
  if (status == cudaSuccess) return;
  throw base::Error(std::string("CUDA, ") + what, cudaGetErrorString(status),
                    status == cudaErrorMemoryAllocation
                        ? "use a GPU with more memory, or a smaller n_* (--n-star, or n_star in a protocol)"
                        : "check the driver, or use --backend cpu");
}

bool launches_overlap() {
  static const bool can = [] {
    int device = 0;
    int major = 0;
    return cudaGetDevice(&device) == cudaSuccess &&
           cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, device) == cudaSuccess &&
           major >= 9;
  }();
  return can;
}

int team_wish(int n) { return n < 50'000 ? 8 : n < 150'000 ? 4 : n < 600'000 ? 2 : 1; }

std::size_t most_block_memory() {
  static const int bytes = [] {
    int device = 0;
    int most = 0;
    check(cudaGetDevice(&device), "device");
    check(cudaDeviceGetAttribute(&most, cudaDevAttrMaxSharedMemoryPerBlockOptin, device), "shared memory");
    return most;
  }();
  return static_cast<std::size_t>(bytes);
}

std::string device_problem() {
  int devices = 0;
  const cudaError_t status = cudaGetDeviceCount(&devices);
  if (status != cudaSuccess) return cudaGetErrorString(status);
  return devices ? "" : "no CUDA device was found";
}

std::int64_t device_bytes_taken() {
  std::size_t left = 0;
  std::size_t all = 0;
  check(cudaMemGetInfo(&left, &all), "memory");
  return static_cast<std::int64_t>(all - left);
}

std::string device_name() {
  int device = 0;
  cudaDeviceProp properties{};
  check(cudaGetDevice(&device), "device");
  check(cudaGetDeviceProperties(&properties, device), "name");
  return properties.name;
}

void* allocate(std::size_t bytes) {
  void* pointer = nullptr;
  if (bytes) check(cudaMalloc(&pointer, bytes), "allocation");
  return pointer;
}
void release(void* pointer) noexcept {
  if (pointer) cudaFree(pointer);
}
void copy_to_host(void* host, const void* device, std::size_t bytes) {
  if (bytes) check(cudaMemcpy(host, device, bytes, cudaMemcpyDeviceToHost), "copy to host");
}
void copy_from_host(void* device, const void* host, std::size_t bytes) {
  if (bytes) check(cudaMemcpy(device, host, bytes, cudaMemcpyHostToDevice), "copy from host");
}
void copy_within(void* to, const void* from, std::size_t bytes) {
  if (bytes) check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice), "copy");
}
void fill_zero(void* device, std::size_t bytes) {
  if (bytes) check(cudaMemsetAsync(device, 0, bytes), "clear");
}
void synchronize() { check(cudaDeviceSynchronize(), "synchronise"); }

namespace {
struct TimedLaunch {
  const char* label;
  cudaEvent_t begin, end;
};
std::deque<TimedLaunch> launches;

cudaEvent_t now() {
  cudaEvent_t event = nullptr;
  cudaEventCreate(&event);
  cudaEventRecord(event);
  return event;
}
}  // namespace

bool LaunchTimer::on = false;

void profile_launches(bool on) {
  LaunchTimer::on = on;
  for (const auto& launch : launches) {
    cudaEventDestroy(launch.begin);
    cudaEventDestroy(launch.end);
  }
  launches.clear();
}

std::vector<LaunchTime> launch_times() {
  synchronize();
  std::map<std::string, LaunchTime> measured;
  for (const auto& launch : launches) {
    float ms = 0;
    check(cudaEventElapsedTime(&ms, launch.begin, launch.end), "timer");
    LaunchTime& pass = measured[launch.label];
    ++pass.launches;
    pass.ms += static_cast<double>(ms);
  }
  return longest_first(measured);
}

void LaunchTimer::begin(const char* label) { launches.push_back({label, now(), nullptr}); }
void LaunchTimer::end() { launches.back().end = now(); }

void Sorter::sort(Array<std::uint64_t>& keys, Array<int>& order) {
  const int n = static_cast<int>(keys.size());
  if (n == 0) return;
  const LaunchTimer timer("sort");
  keys_.resize(keys.size());
  order_.resize(keys.size());
  cub::DoubleBuffer<std::uint64_t> key_buffer(keys.data(), keys_.data());
  cub::DoubleBuffer<int> order_buffer(order.data(), order_.data());
  std::size_t bytes = 0;
  check(cub::DeviceRadixSort::SortPairs(nullptr, bytes, key_buffer, order_buffer, n), "sort");
  if (bytes > scratch_.size()) scratch_.resize(bytes);
  bytes = scratch_.size();
  check(cub::DeviceRadixSort::SortPairs(scratch_.data(), bytes, key_buffer, order_buffer, n), "sort");
  if (key_buffer.Current() != keys.data()) keys.swap(keys_);
  if (order_buffer.Current() != order.data()) order.swap(order_);
}

namespace {

struct IsSet {
  SIM_FN int operator()(std::uint8_t flag) const { return flag != 0; }
};

/// Values: an iterator over ints.
template <class Values>
void sum_inclusively(Values values, int n, Array<int>& sums, Array<unsigned char>& scratch) {
  sums.resize(static_cast<std::size_t>(n));
  if (n == 0) return;
  const LaunchTimer timer("scan");
  std::size_t bytes = 0;
  check(cub::DeviceScan::InclusiveSum(nullptr, bytes, values, sums.data(), n), "scan");
  if (bytes > scratch.size()) scratch.resize(bytes);
  bytes = scratch.size();
  check(cub::DeviceScan::InclusiveSum(scratch.data(), bytes, values, sums.data(), n), "scan");
}

}  // namespace

void Scanner::inclusive_sum(const Array<int>& values, Array<int>& sums) {
  sum_inclusively(values.data(), static_cast<int>(values.size()), sums, scratch_);
}

void Scanner::inclusive_count(const std::uint8_t* flags, int n, Array<int>& counts) {
  sum_inclusively(thrust::make_transform_iterator(flags, IsSet{}), n, counts, scratch_);
}

namespace {

// The sum is reproducible: one block sums each chunk in a fixed tree, and the host adds the chunks in order.
constexpr int chunk = 4096;

__global__ void chunk_sums(const float* values, int n, double* sums) {
  using Reduce = cub::BlockReduce<double, 256>;
  __shared__ typename Reduce::TempStorage storage;
  double part = 0;
  for (int i = threadIdx.x; i < chunk; i += 256) {
    const int at = static_cast<int>(blockIdx.x) * chunk + i;
    if (at < n) part += static_cast<double>(values[at]);
  }
  part = Reduce(storage).Sum(part);
  if (threadIdx.x == 0) sums[blockIdx.x] = part;
}

}  // namespace

double fixed_order_sum(const Array<float>& values, int n) {
  if (n <= 0) return 0;
  Array<double> sums(static_cast<std::size_t>((n + chunk - 1) / chunk));
  chunk_sums<<<static_cast<unsigned>(sums.size()), 256>>>(values.data(), n, sums.data());
  check(cudaGetLastError(), "sum");
  double total = 0;
  for (const double part : sums.to_host()) total += part;
  return total;
}

float maximum(const Array<float>& values, int n) {
  if (n <= 0) return 0;
  Array<float> most(1);
  std::size_t bytes = 0;
  check(cub::DeviceReduce::Max(nullptr, bytes, values.data(), most.data(), n), "maximum");
  Array<unsigned char> scratch(bytes);
  check(cub::DeviceReduce::Max(scratch.data(), bytes, values.data(), most.data(), n), "maximum");
  return most.to_host()[0];
}

}  // namespace sim::SIM_BACKEND
