#pragma once
/// Reads, extends and replaces the file of the journal of answers; answer_journal.hpp explains its lines.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/store/file/journal_rows.hpp"

namespace study {

/// The rows of a journal, by table (parent tables first) and key.
using JournalRows = std::map<std::pair<const journal::Table*, std::string>, journal::Row>;

/// The content of a journal.
struct JournalContent {
  bool exists = false;
  std::int64_t schema = 0;  ///< schema version of the database when the journal was begun
  JournalRows kept;         ///< last version of each row that is marked as kept (committed)
  JournalRows pending;      ///< rows of the last batch if it is ready but not marked as kept
  bool torn = false;        ///< the last batch has unreadable lines, so it was not written completely
  bool rewriting = false;   ///< a rewrite is announced, and no batch follows
  std::vector<std::string> forgotten;  ///< persons whose withdrawal caused an announced rewrite
  std::int64_t last_number = 0;        ///< largest batch number n in a line {"ready": n}
  std::uintmax_t end = 0;              ///< bytes up to the end of the last mark, e.g. {"kept": n}
  std::int64_t unreadable = 0;         ///< number of lines before `end` that are not journal lines
};

/// "<database>.answers.jsonl", beside the real file if `database` is a link.
std::filesystem::path journal_beside(const std::filesystem::path& database);
/// Reads a journal; a missing file gives empty content. base::Error if the path is a link or not a regular
/// file, or if it cannot be read.
JournalContent read_journal(const std::filesystem::path& path);

/// Largest event_id among the rows of table `event`; 0 if there is none.
std::int64_t last_event(const JournalRows& rows);

/// Lines of the journal that are not table rows: first line, end of a batch, commit mark, announced rewrite.
std::string journal_head(std::int64_t schema);
std::string ready_line(std::int64_t number);
std::string kept_line(std::int64_t number);
std::string rewrite_line(const std::vector<std::string>& persons);

/// The journal file for writing; the first append() opens it.
class JournalFile {
 public:
  explicit JournalFile(std::filesystem::path path) : path_(std::move(path)) {}
  ~JournalFile();
  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Appends `text`; a missing or empty file gets the line `head` first. `to_disk` true: flushes the file to
  /// disk. base::Error if writing or flushing fails; the appended bytes are then removed again.
  void append(const std::string& text, const std::string& head, bool to_disk);
  /// Truncates the file to `end` bytes.
  void cut(std::uintmax_t end);
  /// Returns in words how another program changed the file since the last append(); empty if it did not, or
  /// if nothing was appended yet.
  std::string trouble() const;
  /// Closes the file, renames the file that is now at the path, and returns its new path; empty if there is
  /// none. The next append() makes a new file.
  std::filesystem::path set_aside();
  /// Closes the file; the next append() opens the path again.
  void close();

 private:
  void open(const std::string& head);

  std::filesystem::path path_;
  int fd_ = -1;
  std::uintmax_t size_ = 0;  ///< size of the file after this object's last write, bytes
};

/// Replaces the journal by a file with `text`, then overwrites the old journal's bytes and deletes it. At any
/// moment, also after a power cut, the path has a complete journal. An empty `text` only deletes the journal.
void replace_journal(const std::filesystem::path& path, const std::string& text);

/// Overwrites and deletes the draft that a kill in replace_journal() left beside the journal.
void remove_journal_draft(const std::filesystem::path& path);

}  // namespace study
