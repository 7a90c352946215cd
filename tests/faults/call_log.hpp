#pragma once
/// The changes that a program made to its files, in order: a child writes them into shared memory that
/// outlives it.

#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace faults {

/// One change, or a text between changes. Files are identified by their inode.
struct Call {
  enum class Kind : std::uint32_t {
    Create,    ///< `path` is a new file
    Write,     ///< `bytes` at offset `at`
    Truncate,  ///< to `at` bytes, filled with zeros if longer
    Sync,      ///< the file is on the disk
    SyncFolder,
    Rename,    ///< `path` becomes `to`
    Exchange,  ///< `path` and `to` swap names
    Link,      ///< `to` is another name of the file
    Unlink,
    Mkdir,
    Rmdir,
    Words,  ///< a text in `bytes`
    Ended   ///< the command ended by itself; `bytes`: its error, empty if none
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
  /// Call from one thread at a time. Ends the program if the memory is full.
  void add(Call::Kind kind, std::uint64_t file, std::int64_t at, std::string_view path, std::string_view to,
           std::string_view bytes);
  std::vector<Call> read() const;

 private:
  struct Memory;
  Memory* memory_;
};

}  // namespace faults
