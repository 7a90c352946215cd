#pragma once
/// Runs a command of the library in its own process, under a CallPlan (file_calls.hpp): the fault to inject
/// into its calls on files.

#include <functional>
#include <string>
#include <vector>

#include "tests/faults/call_log.hpp"
#include "tests/faults/file_calls.hpp"

namespace faults {

/// How a command ended.
struct Ended {
  enum class How {
    Done,
    Refused,  ///< base::Error
    Killed,   ///< by its plan
    Broken    ///< by anything else: another exception, a signal, a timeout of one minute
  };
  How how = How::Broken;
  std::string problem;      ///< Refused, Broken: the message
  std::vector<Call> calls;  ///< recorded texts, and recorded calls if the plan's `record` is set
  long counted = 0;         ///< number of calls of a command that was not killed
};

/// Runs `command` in a child process under `plan`. `plan.log` must be set; it is emptied first.
Ended run_child(const CallPlan& plan, const std::function<void()>& command);

}  // namespace faults
