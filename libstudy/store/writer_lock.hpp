#pragma once
/// One writer for each database.

#include <filesystem>

namespace study {

/// Held on the file itself, so that it ends with the process however that ends. A file that is not there yet
/// is not locked.
class WriterLock {
 public:
  /// base::Error while another vip-study writes.
  explicit WriterLock(const std::filesystem::path& database);
  ~WriterLock();
  WriterLock(const WriterLock&) = delete;
  WriterLock& operator=(const WriterLock&) = delete;

 private:
  int fd_;
};

}  // namespace study
