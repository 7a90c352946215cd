#include "libstudy/pacing/real_time.hpp"

#include <fcntl.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>

namespace study {

namespace {
constexpr int raised_nice = -10;

/// Requests a wake-up latency of at most most_us from the kernel. Returns the open file, -1 if refused. The
/// request lasts until the file is closed; the lowest request of all programs applies.
int hold_latency(std::int32_t most_us) {
  const int file = open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
  if (file < 0) return -1;
  if (write(file, &most_us, sizeof most_us) == sizeof most_us) return file;
  close(file);
  return -1;
}
}  // namespace

RealTimeScheduling::RealTimeScheduling()
    : old_slack_ns_(static_cast<int>(prctl(PR_GET_TIMERSLACK, 0, 0, 0, 0))) {
  const auto thread = static_cast<id_t>(gettid());
  sched_param priority{};
  priority.sched_priority = sched_get_priority_min(SCHED_FIFO);
  const int policy = sched_getscheduler(0);
  if (sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &priority) == 0) {
    old_policy_ = policy;
    note_ = "SCHED_FIFO";
  } else {
    note_ = std::string("SCHED_FIFO refused (") + std::strerror(errno) + ")";
    errno = 0;
    old_nice_ = getpriority(PRIO_PROCESS, thread);
    niced_ = errno == 0 && setpriority(PRIO_PROCESS, thread, raised_nice) == 0;
    note_ += niced_ ? ", nice " + std::to_string(raised_nice) : ", ordinary priority";
  }
  const bool slack = prctl(PR_SET_TIMERSLACK, 1, 0, 0, 0) == 0;
  note_ += slack ? ", timer slack 1 ns" : ", timer slack unchanged";
  latency_file_ = hold_latency(0);
  note_ += latency_file_ >= 0 ? ", no deep idle states" : ", idle states unchanged";
}

RealTimeScheduling::~RealTimeScheduling() {
  if (latency_file_ >= 0) close(latency_file_);
  prctl(PR_SET_TIMERSLACK, static_cast<unsigned long>(old_slack_ns_), 0, 0, 0);
  const sched_param ordinary{};
  if (old_policy_ >= 0) sched_setscheduler(0, old_policy_, &ordinary);
  if (niced_) setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), old_nice_);
}

}  // namespace study
