/// Replaces the libc calls that return the time of day.
#include <dlfcn.h>
#include <sys/time.h>

#include <ctime>

#include "tests/faults/file_calls_parts.hpp"

using faults::calls::clock_ahead_s;

extern "C" {

int clock_gettime(clockid_t clock, timespec* now) noexcept {
  const int done =
      reinterpret_cast<int (*)(clockid_t, timespec*)>(::dlsym(RTLD_NEXT, "clock_gettime"))(clock, now);
  if (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE) now->tv_sec += clock_ahead_s();
  return done;
}

time_t time(time_t* now) noexcept {
  timespec here{};
  clock_gettime(CLOCK_REALTIME, &here);
  if (now) *now = here.tv_sec;
  return here.tv_sec;
}

int gettimeofday(timeval* now, void*) noexcept {
  timespec here{};
  clock_gettime(CLOCK_REALTIME, &here);
  now->tv_sec = here.tv_sec;
  now->tv_usec = here.tv_nsec / 1000;
  return 0;
}

}  // extern "C"
