#pragma once
/// A layer between a program and its files, clock and life: every call of libc that changes a file below one
/// folder is counted; the k-th one fails, or is the last; all of them are recorded with their data, so that
/// what a power cut leaves can be made afterwards (crash_states.hpp). It serves all code of the program
/// alike: SQLite, the standard library, the journal, personal data, exports, chores and locks.
///
/// Two ways to use one source: compiled into a test program, which arms it in a child, or as a library for
/// LD_PRELOAD, which reads its plan from the environment (file_calls_environment.cpp).
///
/// Counted are open for writing, write, sync, truncate, rename, link, remove, mkdir and the same of stdio;
/// not what is written through a mapping (the index of SQLite's log, which every opening makes anew).

#include <cstdint>
#include <string>

namespace faults {

class CallLog;

/// What happens to the calls of a program.
struct CallPlan {
  enum class Kind {
    None,
    Kill,   ///< SIGKILL before the call
    Tear,   ///< SIGKILL in the call, which writes half of its bytes where it is a write
    Error,  ///< EIO
    Full    ///< ENOSPC: the call that needs room, or the next that does
  };
  std::string folder;  ///< calls on files below it count; absolute, without links; empty: none
  Kind kind = Kind::None;
  bool from_then_on = false;       ///< Error, Full: so do all that follow
  long at = 0;                     ///< number of the call, from 1
  std::int64_t clock_ahead_s = 0;  ///< added to the time of day
  CallLog* log = nullptr;          ///< where words are recorded; none: they are not
  bool record = false;             ///< calls and their data as well
};

/// Counts from 0 again. Not while another thread changes files.
void arm_calls(const CallPlan& plan);
/// Calls since then.
long counted_calls();
/// From now on no two names change places in this process, as on network file systems (EINVAL).
void refuse_exchanges();
/// Records words between the calls, e.g. that an answer was acknowledged. Nothing without a log.
void record_words(const std::string& words);

}  // namespace faults
