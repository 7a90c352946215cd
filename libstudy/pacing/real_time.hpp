#pragma once
/// Asks the operating system to wake the pacing thread on time.

#include <string>

namespace study {

/// During its lifetime, the calling thread has a timer slack of 1 ns and, where the system allows it
/// (RLIMIT_RTPRIO or CAP_SYS_NICE), the scheduling policy SCHED_FIFO at its lowest real-time priority. If
/// SCHED_FIFO is refused, requests the nice level -10, a raised priority. If /dev/cpu_dma_latency can be
/// opened, processors avoid idle states that are slow to leave. Threads that the calling thread starts do not
/// inherit SCHED_FIFO. A refused request is no error: note() lists the granted and refused requests for the
/// session's record. Memory is not locked, because this would pin a mapped bake as well.
class RealTimeScheduling {
 public:
  RealTimeScheduling();
  ~RealTimeScheduling();
  RealTimeScheduling(const RealTimeScheduling&) = delete;
  RealTimeScheduling& operator=(const RealTimeScheduling&) = delete;
  const std::string& note() const { return note_; }

 private:
  std::string note_;
  int old_slack_ns_;
  int old_policy_ = -1;  // -1: unchanged
  bool niced_ = false;
  int old_nice_ = 0;
  int latency_file_ = -1;  // /dev/cpu_dma_latency; the request lasts while the file is open; -1: not open
};

}  // namespace study
