#pragma once
/// A layer between a program and its files and clock. It counts every libc call that changes a file below one
/// folder, and lets the k-th such call fail or kills the program at it. It can record all of these calls with
/// their data, so that the states after a power cut can be computed later (crash_states.hpp). It covers all
/// code of the program alike: SQLite, the standard library, the journal, personal data, exports, chores and
/// locks.
///
/// A test program links the source and arms it, mostly in a forked child. Whole programs load it as a library
/// by LD_PRELOAD; it then reads its plan from the environment (file_calls_environment.cpp).
///
/// It counts open for writing, write, sync, truncate, rename, link, remove, mkdir and their stdio
/// equivalents, but not writes through a mapping (the index of SQLite's log, which every opening rebuilds).
///
/// If the plan says so, it counts reads too, separately: open for reading, read and the listing of a folder.
/// Locks never fail, because SQLite treats a failed lock as a busy one and waits ten seconds.

#include <cstdint>
#include <string>

namespace faults {

class CallLog;

/// The fault to inject into a program's calls.
struct CallPlan {
  enum class Kind {
    None,
    Kill,   ///< SIGKILL before the call
    Tear,   ///< SIGKILL during the call; a write writes half of its bytes
    Error,  ///< EIO
    Full,   ///< ENOSPC: this call, or the next one that needs space
    Pause   ///< SIGSTOP before every at-th read
  };
  std::string folder;  ///< calls on files below it count; absolute, without links; empty: none
  Kind kind = Kind::None;
  bool from_then_on = false;       ///< Error, Full: all later calls fail too
  long at = 0;                     ///< number of the call, from 1
  bool reads = false;              ///< also counts reads; Error then fails reads, not changes
  std::int64_t clock_ahead_s = 0;  ///< added to the time of day
  CallLog* log = nullptr;          ///< where texts are recorded; null: nowhere
  bool record = false;             ///< also records calls and their data
};

/// Starts counting from 0. Do not call it while another thread changes files.
void arm_calls(const CallPlan& plan);
/// Calls since arm_calls() that change files.
long counted_calls();
/// Reads since arm_calls().
long counted_reads();
/// From now on, swapping two names fails in this process, as on network file systems (EINVAL).
void refuse_exchanges();
/// Records a text between the calls, e.g. that an answer was acknowledged. Does nothing without a log.
void record_words(const std::string& words);

}  // namespace faults
