#include "libstudy/base/clock.hpp"

#include <ctime>

namespace study {

namespace {
// Length of the last part of a wait, in which wait_until() spins instead of sleeping, ns. Sleeping threads
// wake late: by some tens of microseconds, and on an idle virtual machine by up to a few milliseconds,
// because its halted processor must be scheduled again. At 50 frames/s, spinning for 8 ms of each 20 ms uses
// 40 % of one core.
constexpr std::int64_t spin_ns = 8'000'000;
}  // namespace

std::int64_t RealClock::now_ns() const {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
}

void RealClock::wait_until(std::int64_t deadline_ns) {
  const std::int64_t sleep_to = deadline_ns - spin_ns;
  if (sleep_to > now_ns()) {
    const timespec target{sleep_to / 1'000'000'000, sleep_to % 1'000'000'000};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &target, nullptr) != 0) {
    }
  }
  while (now_ns() < deadline_ns) {
  }
}

}  // namespace study
