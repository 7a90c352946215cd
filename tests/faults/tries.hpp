#pragma once
/// Injects one fault into one command and checks its outcome and the final content.

#include <filesystem>
#include <functional>
#include <string>

#include "tests/faults/flows.hpp"

namespace faults {

/// A fault in a program.
struct Fault {
  enum class Kind {
    None,
    Kill,      ///< SIGKILL before a call
    Tear,      ///< SIGKILL in the middle of a write
    Instant,   ///< SIGKILL after a delay
    Error,     ///< EIO, once
    ErrorsOn,  ///< EIO from then on
    Full,      ///< ENOSPC, once
    FullOn,    ///< ENOSPC from then on
    Read,      ///< EIO of a read, once
    ReadsOn,   ///< EIO of all reads from then on
    SmallDisk  ///< a small file system of its own that fills up
  };
  Kind kind = Kind::None;
  long at = 0;    ///< number of the call or read, from 1; Instant: microseconds; SmallDisk: free bytes
  int again = 0;  ///< Kill, Instant: number of following commands to kill as well
};

const char* name_of(Fault::Kind kind);
bool kills(Fault::Kind kind);

/// The outcome of a try.
struct Outcome {
  enum class How {
    WentOn,   ///< the command did not meet the fault, or recovered from it
    Refused,  ///< one clear error
    Stopped,  ///< killed
    Failed
  };
  How how = How::WentOn;
  int kills = 0;
  std::string problem;  ///< Failed: the reason
};

/// A flow in a folder, tried repeatedly from the same initial state.
class Bench {
 public:
  /// `folder` is emptied, and only this object may use it. Runs the flow once without a fault.
  Bench(const Flow& flow, const fs::path& folder);
  ~Bench();
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  /// Number of calls by which the command changes its files.
  long calls() const { return calls_; }
  /// Number of calls by which it reads them.
  long reads() const { return reads_; }
  /// Duration of the command.
  long microseconds() const { return microseconds_; }
  Outcome attempt(const Fault& fault);

 private:
  void restore(const Fault& fault);
  void clear();

  const Flow& flow_;
  fs::path start_, now_, peek_;
  Lines wanted_;
  long calls_ = 0, reads_ = 0, microseconds_ = 0;
  long tries_ = 0;
  bool mounted_ = false;
};

/// True if a file system of a given size can be made (needs root).
bool small_disks_can_be_made(const fs::path& folder);

}  // namespace faults
