#pragma once
/// The file of the journal of answers: appends, reads and replaces it. For the meaning of its lines see
/// answer_journal.hpp.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/store/file/journal_rows.hpp"

namespace study {

/// The rows of a journal by table (parents first) and key.
using JournalRows = std::map<std::pair<const journal::Table*, std::string>, journal::Row>;

/// The content of a journal.
struct JournalContent {
  bool exists = false;
  std::int64_t schema = 0;             ///< of the database it was written beside
  JournalRows kept;                    ///< the last kept version of each row
  JournalRows pending;                 ///< ready, but not marked as kept
  bool torn = false;                   ///< a pending line cannot be read: the batch was never complete
  bool rewriting = false;              ///< its last line announces a rewrite
  std::vector<std::string> forgotten;  ///< persons whose withdrawal the rewrite is for
  std::int64_t last_number = 0;        ///< largest n of "ready"
  std::uintmax_t end = 0;              ///< bytes up to the last valid line
  std::int64_t unreadable = 0;         ///< lines before `end` that are not journal lines
};

/// "<database>.answers.jsonl", beside the real file if `database` is a link.
std::filesystem::path journal_beside(const std::filesystem::path& database);
/// Reads a journal; a missing file gives empty content. base::Error: a link, not a file, unreadable.
JournalContent read_journal(const std::filesystem::path& path);

/// Largest number of an event among the rows; 0: none.
std::int64_t last_event(const JournalRows& rows);

/// Journal lines that are not rows.
std::string journal_head(std::int64_t schema);
std::string ready_line(std::int64_t number);
std::string kept_line(std::int64_t number);
std::string rewrite_line(const std::vector<std::string>& persons);

/// The journal file, opened for appending by the first append.
class JournalFile {
 public:
  explicit JournalFile(std::filesystem::path path) : path_(std::move(path)) {}
  ~JournalFile();
  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Appends `text`; makes a missing file with `head` first. `to_disk`: flushes all of it to disk.
  /// base::Error, with the file unchanged, if that fails.
  void append(const std::string& text, const std::string& head, bool to_disk);
  /// Truncates the file to `end` bytes.
  void cut(std::uintmax_t end);
  /// How the file at the path differs from what the last append left, in words; empty: it does not, or
  /// nothing was appended yet.
  std::string trouble() const;
  /// Makes the next append open the path anew. Renames a foreign file at the path and returns its new path;
  /// empty if there was none.
  std::filesystem::path set_aside();
  /// Makes the next append open the path anew.
  void close();

 private:
  void open(const std::string& head);

  std::filesystem::path path_;
  int fd_ = -1;
  std::uintmax_t size_ = 0;  ///< bytes, as this object left it
};

/// Writes a new journal, renames it over the old one, then overwrites and deletes the old bytes. A power cut
/// at any moment leaves a complete journal under the name. An empty `text` deletes the journal.
void replace_journal(const std::filesystem::path& path, const std::string& text);

/// Overwrites and deletes drafts that a kill in replace_journal left beside the journal.
void remove_journal_draft(const std::filesystem::path& path);

}  // namespace study
