#include "libstudy/store/answer_journal.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <cstdio>

#include "libstudy/store/settling.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace fs = std::filesystem;
using journal::Row;
using journal::Table;
using sqlite::Connection;

AnswerJournal::AnswerJournal(Connection& database)
    : database_(database),
      file_(journal_beside(database.path())),
      number_(settle(database, file_).last_number) {
  blank_ = database.integer("SELECT count(*) FROM run") == 0;
  follow();
}

AnswerJournal::~AnswerJournal() {
  if (unmarked_) try_mark();
  sqlite3_update_hook(database_.handle(), nullptr, nullptr);
}

void AnswerJournal::follow() {
  sqlite3_update_hook(
      database_.handle(),
      [](void* self, int, const char*, const char* name, sqlite3_int64 row) {
        if (const Table* table = journal::find_table(name))
          static_cast<AnswerJournal*>(self)->changed_[table].insert(row);
      },
      this);
}

/// If another program removed or changed the journal, sets the changed file aside and begins a new journal.
/// write(), which calls this function, then adds the rows to be committed; kept() adds all other rows after
/// the commit.
void AnswerJournal::look_after_file() {
  const std::string trouble = file_.trouble();
  if (trouble.empty()) return;
  const fs::path aside = file_.set_aside();
  anew_ = true;
  say(file_.path().string() + " " + trouble + " during the session; it is rewritten from the database" +
      (aside.empty() ? "" : ", and the file that was there is now " + aside.string()));
}

void AnswerJournal::write() {
  look_after_file();
  std::string text;
  bool answers = false;
  const auto add = [&](const Row& row) {
    text += row.line + '\n';
    answers |= row.table->answers;
  };
  for (const auto& [table, rows] : changed_) {
    const std::vector<std::int64_t> ids(rows.begin(), rows.end());
    journal::each_row(database_, *table, ids, add);
    if (table->name != std::string("protocol")) continue;
    // `ask` and `cell` have no row numbers, so their changes are not recorded: write them with their
    // protocol.
    for (const std::int64_t protocol : ids) {
      for (const char* part : {"ask", "cell"})
        journal::each_row_of_protocol(database_, *journal::find_table(part), protocol, add);
    }
  }
  if (text.empty()) return;
  if (unmarked_) text = kept_line(number_) + text;
  file_.append(text + ready_line(number_ + 1), head_for(database_), answers);
  unmarked_ = false;
  ++number_;
  waiting_ = true;
}

void AnswerJournal::kept() {
  // Cleared only here. A Store on a temporary copy never calls kept(), so each of its batches has the rows of
  // all its earlier batches too: settle() commits only the last batch of the journal. A rollback clears
  // nothing either, because it would drop the rows of those batches. write() reads each row from the
  // database, so a row that was rolled back is written as it was before, or not at all.
  changed_.clear();
  if (waiting_) blank_ = false;
  unmarked_ = unmarked_ || anew_ || waiting_;
  waiting_ = false;
  if (unmarked_ && !try_mark()) try_mark();
}

void AnswerJournal::write_mark() {
  if (!anew_) return file_.append(kept_line(number_), head_for(database_), false);
  file_.close();
  rewrite_journal(database_);
  number_ = 1;
  anew_ = false;
}

/// Appends the line that marks the last commit as kept, or writes the whole journal if it was begun anew.
/// Returns false, and warns once, if that fails.
bool AnswerJournal::try_mark() {
  try {
    write_mark();
    unmarked_ = false;
    if (!trouble_.empty()) say(file_.path().string() + " is written again and is complete");
    trouble_.clear();
    return true;
  } catch (const base::Error& error) {
    const std::string why = error.what();
    if (trouble_.empty()) say(why.substr(0, why.find('\n')) + "; the last answers are in the database only");
    trouble_ = why;
    return false;
  }
}

void AnswerJournal::require_written() {
  if (!unmarked_ || try_mark()) return;
  throw base::Error(file_.path().string(), "lacks the last answers, which are in the database only",
                    "free space on the disk and see that the file can be written; vip-study resume then "
                    "writes the missing answers into it");
}

void AnswerJournal::say(const std::string& line) const {
  if (tell_) return tell_(line);
  std::fprintf(stderr, "%s\n", line.c_str());
}

void AnswerJournal::remove_if_blank() noexcept {
  try {
    if (blank_) replace_journal(file_.path(), "");
  } catch (const base::Error&) {
    // A journal that cannot be removed does no harm here, because it contains no row marked as kept.
  }
}

void prepare_rewrite(Connection& database, const std::vector<std::string>& persons) {
  JournalFile file(journal_beside(database.path()));
  if (!read_journal(file.path()).exists) return database.keep_log(false);
  settle(database, file);
  file.append(rewrite_line(persons), head_for(database), true);
}

}  // namespace study
