#pragma once
/// Notices when a file that SQLite has open with a log is deleted, replaced or written over by somebody else.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

struct sqlite3;

namespace study {

class FileWatch {
 public:
  /// `database` has `path` open, in WAL mode. As the file is now, it is right.
  FileWatch(std::filesystem::path path, sqlite3* database);

  /// What happened to the file since the last look, e.g. "was deleted or moved away ..."; empty: nothing.
  std::string trouble();
  /// Takes the log away from beside the path, where it would be copied into whatever file stands there next:
  /// to `kept`, or for good. Neither is touched where it is not the one that SQLite has open.
  void take_log_away(const std::optional<std::filesystem::path>& kept) const;

 private:
  /// Which file stands at a path.
  struct Id {
    std::uint64_t device = 0, number = 0;
    bool operator==(const Id&) const = default;
  };
  /// The main file as it was last seen, and how far the log has been copied into it.
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
