#include "libstudy/store/answer_journal.hpp"

#include <sqlite3.h>

#include "libstudy/store/settling.hpp"
#include "stats/base/error.hpp"

namespace study {

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
  sqlite3_update_hook(database_.handle(), nullptr, nullptr);
  sqlite3_rollback_hook(database_.handle(), nullptr, nullptr);
}

void AnswerJournal::follow() {
  sqlite3_update_hook(
      database_.handle(),
      [](void* self, int, const char*, const char* name, sqlite3_int64 row) {
        if (const Table* table = journal::find_table(name))
          static_cast<AnswerJournal*>(self)->changed_[table].insert(row);
      },
      this);
  sqlite3_rollback_hook(
      database_.handle(), [](void* self) { static_cast<AnswerJournal*>(self)->changed_.clear(); }, this);
}

void AnswerJournal::write() {
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
    // What stands in tables without row numbers comes with its protocol.
    for (const std::int64_t protocol : ids) {
      for (const char* part : {"ask", "cell"})
        journal::each_row_of_protocol(database_, *journal::find_table(part), protocol, add);
    }
  }
  if (text.empty()) return;
  file_.append(text + ready_line(number_ + 1), head_for(database_), answers);
  ++number_;
  waiting_ = true;
}

void AnswerJournal::kept() {
  changed_.clear();  // what is never kept stands in the next batch again, for the last one alone is redone
  if (!waiting_) return;
  waiting_ = false;
  blank_ = false;
  try {
    file_.append(kept_line(number_), head_for(database_), false);
  } catch (const base::Error&) {
    // It is kept nevertheless, and the next opening finds it so.
  }
}

void AnswerJournal::remove_if_blank() noexcept {
  try {
    if (blank_) replace_journal(file_.path(), "");
  } catch (const base::Error&) {
    // What is left says nothing that was kept.
  }
}

void prepare_rewrite(Connection& database, const std::vector<std::string>& persons) {
  JournalFile file(journal_beside(database.path()));
  if (!read_journal(file.path()).exists) return;
  settle(database, file);
  file.append(rewrite_line(persons), head_for(database), true);
}

}  // namespace study
