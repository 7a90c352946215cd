#pragma once
/// One fault in one command: what becomes of it, and whether all is there in the end.

#include <filesystem>
#include <functional>
#include <string>

#include "tests/faults/flows.hpp"

namespace faults {

/// What is done to a program.
struct Fault {
  enum class Kind {
    None,
    Kill,      ///< SIGKILL before a call
    Tear,      ///< SIGKILL in the middle of a write
    Instant,   ///< SIGKILL after a time
    Error,     ///< EIO, once
    ErrorsOn,  ///< EIO from then on
    Full,      ///< ENOSPC, once
    FullOn,    ///< ENOSPC from then on
    SmallDisk  ///< a file system of its own, which fills
  };
  Kind kind = Kind::None;
  long at = 0;    ///< number of the call, from 1; Instant: microseconds; SmallDisk: bytes that are free
  int again = 0;  ///< Kill, Instant: so many commands afterwards are killed as well
};

const char* name_of(Fault::Kind kind);
bool kills(Fault::Kind kind);

/// How a try ended.
struct Outcome {
  enum class How {
    WentOn,   ///< the command did not meet the fault, or overcame it
    Refused,  ///< one clear error
    Stopped,  ///< killed
    Failed
  };
  How how = How::WentOn;
  int kills = 0;
  std::string problem;  ///< Failed: what is wrong
};

/// A flow in a folder, where it is tried again and again from the same start.
class Bench {
 public:
  /// base folder: emptied, and used by this alone. Runs the flow without a fault.
  Bench(const Flow& flow, const fs::path& folder);
  ~Bench();
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  /// Calls that the command makes on its files.
  long calls() const { return calls_; }
  /// Time that the command takes.
  long microseconds() const { return microseconds_; }
  Outcome attempt(const Fault& fault);

 private:
  void restore(const Fault& fault);
  void clear();

  const Flow& flow_;
  fs::path start_, now_, peek_;
  Lines wanted_;
  long calls_ = 0, microseconds_ = 0;
  long tries_ = 0;
  bool mounted_ = false;
};

/// True where a file system of a given size can be made (as root).
bool small_disks_can_be_made(const fs::path& folder);

}  // namespace faults
