#include "libstudy/store/answer_journal.hpp"

#include <sqlite3.h>

#include <algorithm>

#include "stats/base/error.hpp"

namespace study {

namespace fs = std::filesystem;
using journal::Row;
using journal::Table;
using sqlite::Connection;

namespace {

std::int64_t schema_of(Connection& database) { return database.integer("PRAGMA user_version"); }

std::string head_for(Connection& database) { return journal_head(schema_of(database)); }

/// Rows as one batch that is kept.
std::string batch(const std::string& rows, std::int64_t number) {
  return rows + ready_line(number) + kept_line(number);
}

/// How a journal and its database stand to each other.
struct Comparison {
  std::string news;            ///< rows that the database has and the journal has not, or otherwise
  std::int64_t lost = 0;       ///< rows that were kept and that the database does not have
  std::int64_t answers = 0;    ///< responses among them
  std::int64_t different = 0;  ///< answers that the database has otherwise than they were kept
};

Comparison compare(Connection& database, const JournalRows& known) {
  const auto is_response = [](const Row& row) { return row.table->name == std::string("response"); };
  Comparison found;
  found.lost = static_cast<std::int64_t>(known.size());
  for (const auto& [key, row] : known) found.answers += is_response(row) ? 1 : 0;
  for (const Table& table : journal::tables()) {
    journal::each_row(database, table, [&](const Row& row) {
      const auto before = known.find({row.table, row.key});
      const bool same = before != known.end() && before->second.line == row.line;
      if (!same) found.news += row.line + '\n';
      if (before == known.end()) return;
      --found.lost;
      if (!is_response(row)) return;
      --found.answers;
      if (!same) ++found.different;
    });
  }
  return found;
}

[[noreturn]] void throw_ahead(const fs::path& database, const Comparison& found) {
  const std::string what = found.lost > 0
                               ? std::to_string(found.answers) + " answers and " +
                                     std::to_string(found.lost - found.answers) +
                                     " other rows stand in the journal alone"
                               : std::to_string(found.different) + " answers stand otherwise in the journal";
  throw base::Error(
      database.string(),
      "is not the database that " + journal_beside(database).filename().string() +
          " was written beside, or lost a part of it: " + what,
      "vip-study salvage --db " + database.string() +
          " --into NEW.db puts both together; if the journal is of another study, move it away");
}

/// Commits what was under way when the program ended.
void roll_forward(Connection& database, const JournalRows& pending) {
  sqlite::Transaction transaction(database);
  for (const auto& [key, row] : pending) {
    const auto now = journal::stands_as(database, row);
    if (now && now->line == row.line) continue;
    if (journal::put(database, row, journal::Put::Replace)) continue;
    throw base::Error(
        database.path().string(),
        "cannot take over what its journal holds of the last commit: " + row.line.substr(0, 200),
        "vip-study salvage --db " + database.path().string() + " --into NEW.db");
  }
  transaction.commit();
}

/// Returns the largest number in use.
std::int64_t settle(Connection& database, JournalFile& file) {
  JournalContent content = read_journal(file.path());
  if (!content.exists || content.rewriting) {
    rewrite_journal(database);
    return 1;
  }
  Comparison found = compare(database, content.kept);
  const bool upgraded = content.schema > 0 && content.schema < schema_of(database);
  if (found.lost > 0 || (found.different > 0 && !upgraded)) throw_ahead(database.path(), found);
  // A power cut kept a part of what was not yet brought to the disk, so that no commit had begun.
  if (content.torn) content.pending.clear();
  if (!content.pending.empty()) {
    roll_forward(database, content.pending);
    for (auto& [key, row] : content.pending) content.kept.insert_or_assign(key, std::move(row));
    found = compare(database, content.kept);
  }
  if (upgraded) {
    rewrite_journal(database);
    return 1;
  }
  file.cut(content.end);
  std::string marks = content.pending.empty() ? "" : kept_line(content.last_number);
  if (!found.news.empty()) marks += batch(found.news, ++content.last_number);
  if (!marks.empty()) file.append(marks, head_for(database), true);
  return content.last_number;
}

}  // namespace

AnswerJournal::AnswerJournal(Connection& database)
    : database_(database), file_(journal_beside(database.path())), number_(settle(database, file_)) {
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

void rewrite_journal(Connection& database) {
  std::string rows;
  for (const Table& table : journal::tables())
    journal::each_row(database, table, [&](const Row& row) { rows += row.line + '\n'; });
  replace_journal(journal_beside(database.path()), rows.empty() ? "" : head_for(database) + batch(rows, 1));
}

}  // namespace study
