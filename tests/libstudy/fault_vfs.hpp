#pragma once
/// A layer between SQLite and the file system, for tests: counts SQLite's calls, and lets one of them fail or
/// be the last, as SQLite's own tests do. While it lives it serves every connection of this process.

#include <cstdint>
#include <functional>

struct sqlite3_vfs;

namespace study::test {

/// What becomes of the k-th call.
struct VfsFault {
  enum class Kind {
    None,
    Error,     ///< it fails with its SQLITE_IOERR_..., once
    ErrorsOn,  ///< so do all calls after it
    Full,      ///< the next write fails with SQLITE_FULL, once
    FullOn,    ///< so do all writes after it
    Stop,      ///< the process ends, without a word
    PowerCut,  ///< likewise, and what was not synced by then is lost
    TornCut    ///< likewise, and of what was not synced any sectors may be on the disk
  };
  Kind kind = Kind::None;
  long at = 0;  ///< from 1
};

/// Exit status of a process that Stop, PowerCut or TornCut ended.
inline constexpr int stopped_status = 77;

/// Registered as SQLite's default until it is destroyed. Without a fault it changes nothing.
///
/// A power cut is modelled by sectors of 512 bytes: each that was written since its file was last synced has
/// its old bytes again (PowerCut), or by chance its old or its new ones (TornCut, from a fixed seed). Files
/// that were made or deleted stay so. The index of the log (-shm) is never on a disk.
class FaultVfs {
 public:
  FaultVfs();
  ~FaultVfs();
  FaultVfs(const FaultVfs&) = delete;
  FaultVfs& operator=(const FaultVfs&) = delete;

  /// Counts from 0 again.
  void arm(const VfsFault& fault);
  void disarm() { arm({}); }
  /// Calls since arm().
  long calls() const;
  /// What is done before each call from now on, but those that it makes itself. Without: nothing.
  void before_each(std::function<void()> work);

 private:
  sqlite3_vfs* vfs_;
};

}  // namespace study::test
