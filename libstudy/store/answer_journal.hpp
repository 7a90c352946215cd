#pragma once
/// "<database>.answers.jsonl": a readable copy of all answers beside the database, from which `vip-study
/// salvage` rebuilds them when the database is damaged or gone. The file has mode 0600. A symbolic link at
/// its path is an error.
///
/// Each line is a JSON object: a table row as it is after a commit (journal_rows.hpp), or a mark such as
/// {"ready": n}. If a row has several lines, the last one is valid. The journal contains the answers and all
/// data that decide which answers count: plans, exclusions, endings, notes, permissions and the event log. It
/// omits frames, slots, head poses and gaze, which have too many rows, and eye-tracker validations, exports
/// and chores. Personal answers are in the personal file only.
///
/// Order of writing for each commit: append the rows and the line {"ready": n}, flushed to disk if the batch
/// contains answers or other rows that must not be lost (journal::Table::answers); commit; append the line
/// {"kept": n}. So every committed answer is on disk in both files. If the last batch has "ready" but no
/// "kept", the program ended during its commit. The next AnswerJournal commits this batch, so its answers are
/// neither lost nor asked again. A truncated last line is ignored. If the database lacks a row marked as
/// kept, the file at its path is not the database that was written: opening it for writing is then an error
/// that names vip-study salvage.
///
/// For code that writes the database:
/// - Store::commit() writes the journal too; every method of Store that changes rows must end with it.
/// - If a change can no longer be committed because the file was replaced or is locked, call write() but not
///   kept(), then end the session. The journal then contains the answers until the database can take them.
/// - A command that changes many rows without a Store (withdraw, merge) calls prepare_rewrite() before its
///   transaction and rewrite_journal() after it.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/store/file/journal_file.hpp"
#include "libstudy/store/file/journal_rows.hpp"

namespace study {

/// Records the row changes of one connection in the journal. Construct it while holding the WriterLock;
/// destroy it before the connection.
class AnswerJournal {
 public:
  /// Reconciles journal and database (settle()). base::Error if the journal has rows that the database lacks,
  /// or other answers (is_ahead()), or if the journal cannot be written.
  explicit AnswerJournal(sqlite::Connection& database);
  ~AnswerJournal();
  AnswerJournal(const AnswerJournal&) = delete;
  AnswerJournal& operator=(const AnswerJournal&) = delete;

  /// Call before the commit: appends to the journal the rows that were changed since the last kept().
  /// base::Error, with the journal unchanged, if the journal cannot be written.
  void write();
  /// Call after the commit: marks the batch of the last write() in the journal as kept (committed). If the
  /// mark cannot be written, gives a warning; the next write(), require_written() and the destructor try
  /// again.
  void kept();
  /// base::Error if the journal still lacks committed rows or their mark, after one more try to write them.
  void require_written();
  /// Sets the receiver of one-line warnings about the journal; default: stderr.
  void tell_with(std::function<void(const std::string&)> tell) { tell_ = std::move(tell); }
  /// Removes the journal if the database had no run when this object was constructed and no batch was
  /// committed since.
  void remove_if_blank() noexcept;

 private:
  void follow();
  void look_after_file();
  void write_mark();
  bool try_mark();
  void say(const std::string& line) const;

  sqlite::Connection& database_;
  JournalFile file_;
  std::function<void(const std::string&)> tell_;
  std::map<const journal::Table*, std::set<std::int64_t>> changed_;  // rows changed since kept(), by table
  std::int64_t number_ = 0;                                          // number of the last batch written
  bool waiting_ = false;   // a batch was written, and its commit has not been confirmed by kept()
  bool unmarked_ = false;  // a batch was committed, but the journal lacks its "kept" mark
  bool anew_ = false;      // the journal was lost and begun anew: it lacks the earlier rows
  std::string trouble_;    // why the last mark could not be written (reported already); empty: it was written
  bool blank_ = true;      // the database has no run, and no batch was committed
};

/// Call before a transaction that changes the whole database. If there is a journal, appends a line to it
/// that announces the change and names the `persons` who withdraw. After that line, a journal that does not
/// match the database is rewritten instead of refused, and salvage omits these people. base::Error if the
/// journal already has rows that the database lacks, or other answers, or if it cannot be written.
void prepare_rewrite(sqlite::Connection& database, const std::vector<std::string>& persons = {});
/// Replaces the journal by one with the database's current rows, and overwrites the old journal's bytes.
void rewrite_journal(sqlite::Connection& database);

}  // namespace study
