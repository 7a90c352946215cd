/// Reads the plan of file_calls.hpp for a whole program (LD_PRELOAD) from the environment:
///
///   VIP_FAULT_FOLDER  calls on files below it are counted, from 1; absolute, without links
///   VIP_FAULT         "kill:K", "tear:K", "eio:K", "eio+:K", "enospc:K", "enospc+:K" (+: and all later
///                     calls); "read:K", "read+:K": EIO of the K-th read
///   VIP_FAULT_COUNT   file that gets the numbers of calls and of reads if the program ends by itself
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/faults/file_calls.hpp"

namespace {

using faults::CallPlan;

CallPlan plan_of_environment() {
  CallPlan plan;
  if (const char* folder = std::getenv("VIP_FAULT_FOLDER")) plan.folder = folder;
  const char* fault = std::getenv("VIP_FAULT");
  plan.reads = std::getenv("VIP_FAULT_COUNT") || (fault && !std::strncmp(fault, "read", 4));
  char name[16] = "";
  if (!fault || std::sscanf(fault, "%15[a-z+]:%ld", name, &plan.at) != 2) return plan;
  const std::size_t last = std::strlen(name) - 1;
  if (name[last] == '+') {
    plan.from_then_on = true;
    name[last] = 0;
  }
  using Kind = CallPlan::Kind;
  plan.kind = !std::strcmp(name, "kill")                                ? Kind::Kill
              : !std::strcmp(name, "tear")                              ? Kind::Tear
              : !std::strcmp(name, "eio") || !std::strcmp(name, "read") ? Kind::Error
              : !std::strcmp(name, "enospc")                            ? Kind::Full
                                                                        : Kind::None;
  return plan;
}

struct Program {
  Program() { faults::arm_calls(plan_of_environment()); }
  ~Program() {
    const char* path = std::getenv("VIP_FAULT_COUNT");
    const long calls = faults::counted_calls(), reads = faults::counted_reads();
    if (!path) return;
    faults::arm_calls({});
    const int fd = ::open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    char text[48];
    const int n = std::snprintf(text, sizeof text, "%ld %ld\n", calls, reads);
    if (fd < 0) return;
    if (::write(fd, text, static_cast<std::size_t>(n)) != n) std::abort();
    ::close(fd);
  }
} program;

}  // namespace
