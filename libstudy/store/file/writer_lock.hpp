#pragma once
/// The lock of the one vip-study process that may write a database. Only the short writes that register an
/// export work without it (export_register.hpp).

#include <filesystem>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// A lock on the database file itself; the system releases it when the process ends in any way. Construct it
/// before SQLite opens the file, and destroy it after all connections: closing its descriptor releases the
/// locks that SQLite has on the file in this process.
class WriterLock {
 public:
  /// Locks the file. Open::Create first makes a missing file, empty and with mode 0600. base::Error if
  /// another vip-study has the lock, if the file cannot be opened for writing, or, with Open::Create, if a
  /// log without its database is at the path (refuse_orphaned_log()).
  explicit WriterLock(const std::filesystem::path& database, sqlite::Open how = sqlite::Open::Write);
  /// Removes the file, and SQLite's files beside it, if made() is true and the locked file is still at the
  /// path.
  ~WriterLock();
  WriterLock(const WriterLock&) = delete;
  WriterLock& operator=(const WriterLock&) = delete;

  /// Call once data are stored in the file, so that the destructor does not remove it.
  void keep() { made_ = false; }
  /// True if Open::Create made the file or found it empty, and keep() was not called.
  bool made() const { return made_; }

 private:
  std::filesystem::path path_;
  bool made_ = false;
  int fd_ = -1;
};

}  // namespace study
