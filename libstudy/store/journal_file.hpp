#pragma once
/// The file of the journal of answers: how it is appended to, read and replaced. What its lines mean:
/// answer_journal.hpp.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/store/journal_rows.hpp"

namespace study {

/// The rows of a journal by table (parents first) and key.
using JournalRows = std::map<std::pair<const journal::Table*, std::string>, journal::Row>;

/// A journal as read.
struct JournalContent {
  bool exists = false;
  std::int64_t schema = 0;  ///< of the database that it was written beside
  JournalRows kept;         ///< each row as it was last kept
  JournalRows pending;      ///< ready, but not known to be kept
  bool torn = false;        ///< a line among the pending ones cannot be read: they never were whole
  bool rewriting = false;   ///< the last that it says: it is about to be written anew
  std::vector<std::string> forgotten;  ///< persons that withdrew while it was
  std::int64_t last_number = 0;        ///< largest n of "ready"
  std::uintmax_t end = 0;              ///< bytes up to the last line that counts
  std::int64_t unreadable = 0;         ///< lines before it that are not of a journal
};

/// "<database>.answers.jsonl", beside the database itself where `database` is a link to it.
std::filesystem::path journal_beside(const std::filesystem::path& database);
/// A missing file is an empty content. base::Error: a link, not a file, unreadable.
JournalContent read_journal(const std::filesystem::path& path);

/// Largest number of an event; 0: none.
std::int64_t last_event(const JournalRows& rows);

/// Lines that are no rows.
std::string journal_head(std::int64_t schema);
std::string ready_line(std::int64_t number);
std::string kept_line(std::int64_t number);
std::string rewrite_line(const std::vector<std::string>& persons);

/// The file, open for appending from the first append on.
class JournalFile {
 public:
  explicit JournalFile(std::filesystem::path path) : path_(std::move(path)) {}
  ~JournalFile();
  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Makes the file with `head` unless it is there. `to_disk`: returns when all of it is on the disk.
  /// base::Error, with the file as it was, when that fails.
  void append(const std::string& text, const std::string& head, bool to_disk);
  /// Cuts off what stands behind `end`.
  void cut(std::uintmax_t end);
  /// Why the file at the path is not as the last append left it, in words; empty: it is, or nothing was
  /// appended yet.
  std::string trouble() const;
  /// The next append opens the path anew. A file of somebody else that stands there is renamed before, to the
  /// path that is returned; empty: none stood there.
  std::filesystem::path set_aside();
  /// The next append opens the path anew.
  void close();

 private:
  void open(const std::string& head);

  std::filesystem::path path_;
  int fd_ = -1;
  std::uintmax_t size_ = 0;  ///< bytes, as this object left it
};

/// Writes a new journal, gives it the name of the old one, then overwrites and deletes the old one. A power
/// cut at any moment leaves a whole journal under the name. An empty `text` deletes the journal.
void replace_journal(const std::filesystem::path& path, const std::string& text);

/// Overwrites and deletes what a kill in replace_journal left beside the journal.
void remove_journal_draft(const std::filesystem::path& path);

}  // namespace study
