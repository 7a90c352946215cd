#include "libstudy/pacing/real_time.hpp"

#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace study {

namespace {
constexpr int raised_nice = -10;
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
}

RealTimeScheduling::~RealTimeScheduling() {
  prctl(PR_SET_TIMERSLACK, static_cast<unsigned long>(old_slack_ns_), 0, 0, 0);
  const sched_param ordinary{};
  if (old_policy_ >= 0) sched_setscheduler(0, old_policy_, &ordinary);
  if (niced_) setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), old_nice_);
}

}  // namespace study
