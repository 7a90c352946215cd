#pragma once
/// Watches a file that SQLite has open in WAL mode: detects that another program deleted, replaced or
/// overwrote it.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

struct sqlite3;

namespace study {

class FileWatch {
 public:
  /// Begins the watch; the file's current state is the reference. `database` has `path` open in WAL mode.
  FileWatch(std::filesystem::path path, sqlite3* database);

  /// Returns in words how another program changed the file or removed its log since the watch began, e.g.
  /// "was deleted or moved away while it was in use"; empty if no program did so. While another program
  /// copies the log into the file, returns an empty text; a later call then reports an overwritten file.
  std::string trouble();
  /// Moves the log to `kept`, or deletes the log if `kept` is empty, and deletes the log's shared memory. So
  /// SQLite does not copy the log into another file at the same path. Leaves a log or shared memory that
  /// another program has put at these paths.
  void take_log_away(const std::optional<std::filesystem::path>& kept) const;

 private:
  /// Device and inode number, which identify a file.
  struct Id {
    std::uint64_t device = 0, number = 0;
    bool operator==(const Id&) const = default;
  };
  /// Size and modification time of the database file, the salts of its log, and the number of log frames that
  /// were copied into the file.
  struct Look {
    std::int64_t bytes = 0, written_ns = 0;
    std::uint32_t salt[2] = {}, copied = 0, being_copied = 0;
  };
  static std::optional<Id> id_of(const std::filesystem::path& path);
  std::optional<Look> seen_now() const;
  bool written_by_somebody();

  std::filesystem::path path_, log_, shared_;
  sqlite3* database_;
  std::optional<Id> file_id_, log_id_, shared_id_;
  std::optional<Look> last_;
};

}  // namespace study
