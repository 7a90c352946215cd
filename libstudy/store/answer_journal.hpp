#pragma once
/// "<database>.answers.jsonl": a readable copy of all answers beside the database, from which `vip-study
/// salvage` rebuilds them when the database is damaged or gone. Mode 0600; links are not followed.
///
/// One JSON object a line, each the row of a table as it stands after a commit (journal_rows.hpp), the last
/// line of a row counts: answers, and all that says what counts of them (plans, exclusions, endings, notes,
/// permissions, the log). Frames and gaze are too many for it; personal answers have their own file and stand
/// in neither.
///
/// Order, for each commit: the rows and {"ready": n}, brought to the disk where answers are concerned; the
/// commit;
/// {"kept": n}. So nothing that is said to be kept stands in one place alone. Rows that are ready and not
/// kept, the last in the file, were under way when the program ended: the next AnswerJournal commits
/// them, so that they are neither lost nor asked again. A cut last line is left out. Rows that were kept and
/// are not in the database mean that the database is not the one that was written: opening it for writing is
/// then an error that names salvage.
///
/// For who writes the database:
/// - Store::commit() does all this; a method of Store that changes rows ends in it and needs nothing else.
/// - What cannot be committed any more, since the file was replaced or is locked: call write() and not
/// kept(), then end
///   the session. The answers are then in the journal and wait there for the database.
/// - Commands that change many rows without a Store (withdraw, merge): prepare_rewrite() before their
/// transaction,
///   rewrite_journal() after it.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/store/journal_file.hpp"
#include "libstudy/store/journal_rows.hpp"

namespace study {

/// Follows what one connection changes. Not before the writer's lock is held, and gone before the connection.
class AnswerJournal {
 public:
  /// Brings journal and database together as described above. base::Error when the journal holds more than
  /// the database, or cannot be written.
  explicit AnswerJournal(sqlite::Connection& database);
  ~AnswerJournal();
  AnswerJournal(const AnswerJournal&) = delete;
  AnswerJournal& operator=(const AnswerJournal&) = delete;

  /// Before the commit: appends what the open transaction changed. base::Error, with the file as it was, when
  /// it cannot be written.
  void write();
  /// After the commit. What cannot be written now is said, and tried again by the next write(), by
  /// require_written() and at the end.
  void kept();
  /// base::Error when the journal still lacks what was committed.
  void require_written();
  /// Who is to be told, in one line, of a journal that is not as it should be; without: stderr.
  void tell_with(std::function<void(const std::string&)> tell) { tell_ = std::move(tell); }
  /// Removes the file when nothing in it was ever kept.
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
  bool waiting_ = false;                                             // written and not kept
  bool unmarked_ = false;  // committed, and the journal does not say so yet
  bool anew_ = false;      // the file was lost: it holds a part of what the database does
  std::string trouble_;    // why the last mark could not be written; said already
  bool blank_ = true;
};

/// Says in the journal that the database is about to be changed as a whole and that these people are to be
/// forgotten: from here on a journal that does not match is written anew, and salvage leaves these people
/// out. base::Error as AnswerJournal().
void prepare_rewrite(sqlite::Connection& database, const std::vector<std::string>& persons = {});
/// Makes the journal anew from what the database holds now; the old bytes are overwritten first.
void rewrite_journal(sqlite::Connection& database);

}  // namespace study
