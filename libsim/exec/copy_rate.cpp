#include <algorithm>
#include <array>
#include <chrono>

#include "libsim/exec/space.hpp"
#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Size of the array that is copied; source and destination together exceed most caches.
constexpr std::size_t bytes = std::size_t{256} << 20;
constexpr std::size_t repeats = 5;
#ifdef SIM_CUDA
/// Number of copies per timing. A copy takes a fraction of a millisecond. Several are timed together, so that
/// the wait for their end, some microseconds, has little effect.
constexpr int in_a_row = 8;
#else
constexpr int in_a_row = 1;
#endif

struct CopyOne {
  const Vec4* from;
  Vec4* to;
  SIM_FN void operator()(int i) const { to[i] = from[i]; }
};

template <class Copy>
double median_seconds(Copy copy) {
  copy();  // untimed: touches the memory pages first
  synchronize();
  std::array<double, repeats> seconds{};
  for (double& each : seconds) {
    const auto start = std::chrono::steady_clock::now();
    for (int k = 0; k < in_a_row; ++k) copy();
    synchronize();
    each = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / in_a_row;
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[repeats / 2];
}

}  // namespace

double copy_bandwidth_gb_s() {
  Array<Vec4> from(bytes / sizeof(Vec4));
  Array<Vec4> to(from.size());
  from.zero();
  const int n = static_cast<int>(from.size());
  const double whole = median_seconds([&] { copy_within(to.data(), from.data(), bytes); });
  const double shared = median_seconds([&] { for_each("copy", n, CopyOne{from.data(), to.data()}); });
  return 2 * static_cast<double>(bytes) / std::min(whole, shared) / 1e9;
}

}  // namespace sim::SIM_BACKEND
