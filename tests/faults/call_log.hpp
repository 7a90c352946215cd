#pragma once
/// What a program did to its files, in order: written by a child into memory that outlives it.

#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace faults {

/// One change, or words between them. Files are known by their inode.
struct Call {
  enum class Kind : std::uint32_t {
    Create,    ///< `path` is a new file
    Write,     ///< `bytes` at `at`
    Truncate,  ///< to `at` bytes, or longer with zeros
    Sync,      ///< the file is on the disk
    SyncFolder,
    Rename,    ///< `path` becomes `to`
    Exchange,  ///< `path` and `to` change places
    Link,      ///< `to` is one more name of the file
    Unlink,
    Mkdir,
    Rmdir,
    Words,  ///< `bytes`
    Ended   ///< the command ended by itself; `bytes`: its error, empty for none
  };
  Kind kind = Kind::Words;
  std::uint64_t file = 0;
  std::int64_t at = 0;
  std::string path, to, bytes;
};

class CallLog {
 public:
  CallLog();
  ~CallLog();
  CallLog(const CallLog&) = delete;
  CallLog& operator=(const CallLog&) = delete;

  void clear();
  /// From one thread at a time. Ends the program where the memory is full.
  void add(Call::Kind kind, std::uint64_t file, std::int64_t at, std::string_view path, std::string_view to,
           std::string_view bytes);
  std::vector<Call> read() const;

 private:
  struct Memory;
  Memory* memory_;
};

}  // namespace faults
