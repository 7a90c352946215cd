#include <omp.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <new>

#include "libsim/exec/gl_sharing.hpp"
#include "libsim/exec/space.hpp"

namespace sim::SIM_BACKEND {

void* allocate(std::size_t bytes) {
  constexpr std::size_t line = 64;
  void* pointer = std::aligned_alloc(line, (bytes + line) / line * line);
  if (!pointer) throw std::bad_alloc();
  return pointer;
}
void release(void* pointer) noexcept { std::free(pointer); }
void copy_to_host(void* host, const void* device, std::size_t bytes) {
  if (bytes) std::memcpy(host, device, bytes);
}
void copy_from_host(void* device, const void* host, std::size_t bytes) {
  if (bytes) std::memcpy(device, host, bytes);
}
void copy_within(void* to, const void* from, std::size_t bytes) {
  if (bytes) std::memcpy(to, from, bytes);
}
void fill_zero(void* device, std::size_t bytes) {
  if (bytes) std::memset(device, 0, bytes);
}
void synchronize() {}

int grain_of(int n) {
  constexpr int least = 64;
  constexpr int most = 512;
  constexpr int turns = 8;
  return std::clamp(n / (turns * omp_get_max_threads()), least, most);
}

namespace {
using Clock = std::chrono::steady_clock;
std::map<std::string, LaunchTime> measured;
const char* running = "";
Clock::time_point since;
}  // namespace

bool LaunchTimer::on = false;

void profile_launches(bool on) {
  measured.clear();
  LaunchTimer::on = on;
}
std::vector<LaunchTime> launch_times() { return longest_first(measured); }

void LaunchTimer::begin(const char* label) {
  running = label;
  since = Clock::now();
}
void LaunchTimer::end() {
  LaunchTime& pass = measured[running];
  ++pass.launches;
  pass.ms += std::chrono::duration<double, std::milli>(Clock::now() - since).count();
}

namespace {

// Least-significant-digit radix sort over fixed chunks: stable, and so independent of the number of threads.
// A digit that has the same value in all keys needs no pass.
constexpr int digit_bits = 11;
constexpr int buckets = 1 << digit_bits;
constexpr int chunks = 8;
using Histogram = std::array<std::array<int, buckets>, chunks>;

int chunk_begin(int chunk, int n) { return static_cast<int>(static_cast<std::int64_t>(n) * chunk / chunks); }

void count_digits(const std::uint64_t* keys, int n, int shift, Histogram& counts) {
#pragma omp parallel for schedule(static, 1)
  for (int c = 0; c < chunks; ++c) {
    auto& row = counts[static_cast<std::size_t>(c)];
    row.fill(0);
    for (int i = chunk_begin(c, n); i < chunk_begin(c + 1, n); ++i) ++row[(keys[i] >> shift) & (buckets - 1)];
  }
}

/// Converts counts to start indices. Returns true, with the conversion incomplete, if one bucket contains all
/// keys: the digit then needs no pass.
bool place_digits(Histogram& counts, int n) {
  int sum = 0;
  for (int b = 0; b < buckets; ++b) {
    const int before = sum;
    for (auto& row : counts) {
      const int count = row[static_cast<std::size_t>(b)];
      row[static_cast<std::size_t>(b)] = sum;
      sum += count;
    }
    if (sum - before == n) return true;
  }
  return false;
}

}  // namespace

void Sorter::sort(Array<std::uint64_t>& keys, Array<int>& order) {
  const LaunchTimer timer("sort");
  const int n = static_cast<int>(keys.size());
  keys_.resize(keys.size());
  order_.resize(keys.size());
  auto counts = std::make_unique<Histogram>();
  for (int shift = 0; shift < 64; shift += digit_bits) {
    count_digits(keys.data(), n, shift, *counts);
    if (place_digits(*counts, n)) continue;
    const std::uint64_t* key_in = keys.data();
    const int* order_in = order.data();
    std::uint64_t* key_out = keys_.data();
    int* order_out = order_.data();
#pragma omp parallel for schedule(static, 1)
    for (int c = 0; c < chunks; ++c) {
      auto& next = (*counts)[static_cast<std::size_t>(c)];
      for (int i = chunk_begin(c, n); i < chunk_begin(c + 1, n); ++i) {
        const int place = next[(key_in[i] >> shift) & (buckets - 1)]++;
        key_out[place] = key_in[i];
        order_out[place] = order_in[i];
      }
    }
    keys.swap(keys_);
    order.swap(order_);
  }
}

void Scanner::inclusive_sum(const Array<int>& values, Array<int>& sums) {
  const LaunchTimer timer("scan");
  sums.resize(values.size());
  int sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) sums.data()[i] = sum += values.data()[i];
}

void Scanner::inclusive_count(const std::uint8_t* flags, int n, Array<int>& counts) {
  const LaunchTimer timer("scan");
  counts.resize(static_cast<std::size_t>(n));
  int count = 0;
  for (int i = 0; i < n; ++i) counts.data()[i] = count += flags[i] != 0;
}

double fixed_order_sum(const Array<float>& values, int n) {
  double total = 0;
  constexpr int chunk = 4096;
  for (int begin = 0; begin < n; begin += chunk) {
    double part = 0;
    for (int i = begin; i < std::min(n, begin + chunk); ++i) part += static_cast<double>(values.data()[i]);
    total += part;
  }
  return total;
}

float maximum(const Array<float>& values, int n) {
  float most = 0;
  for (int i = 0; i < n; ++i) most = std::max(most, values.data()[i]);
  return most;
}

// The CPU back end shares no buffers with GL: particles reach GL by upload, and pictures are read back.
GlSharing::~GlSharing() = default;
bool GlSharing::accept(const std::vector<GlBufferRef>&) { return false; }
const std::vector<void*>& GlSharing::map() { return memory_; }
void GlSharing::unmap() {}

}  // namespace sim::SIM_BACKEND
