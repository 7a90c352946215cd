#pragma once
/// One writer for each database, which alone makes the file and alone may remove it again.

#include <filesystem>

#include "libstudy/store/sqlite.hpp"

namespace study {

/// Held on the file itself, so that it ends with the process however that ends. Must be there before SQLite
/// opens the file and outlive every connection to it: closing its descriptor takes away SQLite's own locks in
/// this process.
class WriterLock {
 public:
  /// Open::Create makes a missing file, empty and 0600, and takes over one that it finds empty. base::Error
  /// while another vip-study writes, and when the file cannot be opened for writing.
  explicit WriterLock(const std::filesystem::path& database, sqlite::Open how = sqlite::Open::Write);
  /// Removes a file that was made or taken over here, unless something came to stand in it.
  ~WriterLock();
  WriterLock(const WriterLock&) = delete;
  WriterLock& operator=(const WriterLock&) = delete;

  /// Something stands in the file now: it stays.
  void keep() { made_ = false; }
  /// Whether the file was empty at first and may go again.
  bool made() const { return made_; }

 private:
  std::filesystem::path path_;
  bool made_ = false;
  int fd_ = -1;
};

}  // namespace study
