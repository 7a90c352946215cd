#pragma once
/// "<database>.answers.jsonl": a readable copy of all answers beside the database, from which `vip-study
/// salvage` rebuilds them when the database is damaged or gone. Mode 0600; links are not followed.
///
/// One JSON object per line: a table row after a commit (journal_rows.hpp). Of several lines of a row, the
/// last one is valid. It holds answers and all that decides which answers count (plans, exclusions, endings,
/// notes, permissions, the log), but no frames, slots and gaze, which are too many. Personal answers are only
/// in the personal file.
///
/// Order for each commit: append the rows and {"ready": n}, flushed to disk if the batch has answers; commit;
/// append {"kept": n}. So every acknowledged row is in both files. A last batch that is ready but not kept
/// was under way when the program ended: the next AnswerJournal commits it, so that its answers are neither
/// lost nor asked again. A truncated last line is ignored. Kept rows that are not in the database show that
/// it is not the database that was written: opening it for writing is then an error that names salvage.
///
/// For code that writes the database:
/// - Store::commit() does all this; a method of Store that changes rows must end with it.
/// - If a change can no longer be committed, because the file was replaced or is locked: call write() but not
///   kept(), then end the session. The journal then holds the answers until the database can take them.
/// - Commands that change many rows without a Store (withdraw, merge): call prepare_rewrite() before their
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

/// Records the changes of one connection. Construct it while holding the writer's lock; destroy it before the
/// connection.
class AnswerJournal {
 public:
  /// Reconciles journal and database as described above. base::Error if the journal holds more than the
  /// database or cannot be written.
  explicit AnswerJournal(sqlite::Connection& database);
  ~AnswerJournal();
  AnswerJournal(const AnswerJournal&) = delete;
  AnswerJournal& operator=(const AnswerJournal&) = delete;

  /// Call before the commit: appends the rows that the open transaction changed. base::Error, with the file
  /// unchanged, if it cannot be written.
  void write();
  /// Call after the commit. Reports a failed write; the next write(), require_written() and the destructor
  /// retry it.
  void kept();
  /// base::Error if the journal still lacks committed rows.
  void require_written();
  /// Sets the receiver of one-line warnings about the journal; default: stderr.
  void tell_with(std::function<void(const std::string&)> tell) { tell_ = std::move(tell); }
  /// Removes the file if nothing in it was ever kept.
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
  std::map<const journal::Table*, std::set<std::int64_t>> changed_;  // row numbers
  std::int64_t number_ = 0;                                          // of the last rows written
  bool waiting_ = false;                                             // rows were written but not yet kept
  bool unmarked_ = false;  // committed, but the journal lacks the "kept" mark
  bool anew_ = false;      // the file was lost and begun anew: it holds only a part of the database's rows
  std::string trouble_;    // why the last mark could not be written; already reported
  bool blank_ = true;
};

/// Marks in the journal that the whole database is about to change and that these people are withdrawn. From
/// then on a journal that does not match is rewritten, and salvage omits these people. base::Error as
/// AnswerJournal().
void prepare_rewrite(sqlite::Connection& database, const std::vector<std::string>& persons = {});
/// Rewrites the journal from the database's current rows and overwrites the old bytes.
void rewrite_journal(sqlite::Connection& database);

}  // namespace study
