#pragma once
/// Detects that a file that SQLite has open in WAL mode was deleted, replaced or overwritten by another
/// program.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

struct sqlite3;

namespace study {

class FileWatch {
 public:
  /// `database` has `path` open in WAL mode. The file's current state is the reference.
  FileWatch(std::filesystem::path path, sqlite3* database);

  /// What happened to the file since the last call, e.g. "was deleted or moved away ..."; empty: nothing.
  std::string trouble();
  /// Moves the log to `kept`, or deletes it, and deletes the shared memory, so that SQLite does not copy the
  /// log into the next file at the path. Does not touch a file that is not the one SQLite has open.
  void take_log_away(const std::optional<std::filesystem::path>& kept) const;

 private:
  /// Identity of the file at a path.
  struct Id {
    std::uint64_t device = 0, number = 0;
    bool operator==(const Id&) const = default;
  };
  /// State of the main file at the last look, and how far the log was copied into it.
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
