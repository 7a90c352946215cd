#pragma once
/// A layer between SQLite and the file system for tests: counts SQLite's calls, and lets one of them fail or
/// end the process, as SQLite's own tests do. While it lives it serves all connections of this process.

#include <cstdint>
#include <functional>

struct sqlite3_vfs;

namespace study::test {

/// The fault at one call.
struct VfsFault {
  enum class Kind {
    None,
    Error,     ///< the call fails with its SQLITE_IOERR_..., once
    ErrorsOn,  ///< this call and all later ones fail
    Full,      ///< the next write fails with SQLITE_FULL, once
    FullOn,    ///< this write and all later ones fail
    Stop,      ///< the process ends without cleaning up
    PowerCut,  ///< the same, and unsynced data are lost
    TornCut    ///< the same, and any unsynced sectors may be on the disk
  };
  Kind kind = Kind::None;
  long at = 0;  ///< number of the call, from 1
};

/// Exit status of a process that Stop, PowerCut or TornCut ended.
inline constexpr int stopped_status = 77;

/// Replaces SQLite's default VFS until it is destroyed. Without a fault it changes nothing.
///
/// A power cut is modelled by sectors of 512 bytes: each sector written since its file was last synced gets
/// its old bytes back (PowerCut), or at random its old or new ones (TornCut, from a fixed seed). Created and
/// deleted files stay created and deleted. The log's index (-shm) is never on a disk.
class FaultVfs {
 public:
  FaultVfs();
  ~FaultVfs();
  FaultVfs(const FaultVfs&) = delete;
  FaultVfs& operator=(const FaultVfs&) = delete;

  /// Starts counting from 0 again.
  void arm(const VfsFault& fault);
  void disarm() { arm({}); }
  /// Calls since arm().
  long calls() const;
  /// Runs `work` before each call from now on, except for the calls that `work` makes. Empty: nothing.
  void before_each(std::function<void()> work);

 private:
  sqlite3_vfs* vfs_;
};

}  // namespace study::test
