#pragma once
/// Lock for the only writer of a database, which alone may create the file and remove it again.

#include <filesystem>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// Held on the file itself, so that it ends with the process in any case. Take it before SQLite opens the
/// file and release it after every connection: closing its descriptor releases SQLite's own locks in this
/// process.
class WriterLock {
 public:
  /// Open::Create makes a missing file, empty and 0600, and takes over an empty one. base::Error if another
  /// vip-study writes, or if the file cannot be opened for writing.
  explicit WriterLock(const std::filesystem::path& database, sqlite::Open how = sqlite::Open::Write);
  /// Removes a file that was made or taken over here, unless something was stored in it.
  ~WriterLock();
  WriterLock(const WriterLock&) = delete;
  WriterLock& operator=(const WriterLock&) = delete;

  /// Call once something is stored in the file: it stays.
  void keep() { made_ = false; }
  /// True if the file was empty at first and may be removed again.
  bool made() const { return made_; }

 private:
  std::filesystem::path path_;
  bool made_ = false;
  int fd_ = -1;
};

}  // namespace study
