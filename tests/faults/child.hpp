#pragma once
/// A command of the library in a process of its own, under a plan of file_calls.hpp.

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
    Broken    ///< by anything else: another exception, a signal, a minute without end
  };
  How how = How::Broken;
  std::string problem;      ///< Refused, Broken: what it said
  std::vector<Call> calls;  ///< what it did and said; the calls where the plan records them
  long counted = 0;         ///< calls of a command that was not killed
};

/// `plan.log` is emptied first and must be set.
Ended run_child(const CallPlan& plan, const std::function<void()>& command);

}  // namespace faults
