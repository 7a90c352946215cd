#include "libstudy/store/settling.hpp"

#include "libstudy/store/answer_journal.hpp"
#include "libstudy/store/chores.hpp"
#include "libstudy/store/file/backups.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/refusals.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace fs = std::filesystem;
using journal::Row;
using journal::Table;
using sqlite::Connection;
using sqlite::Statement;
using sqlite::Transaction;

namespace {

std::int64_t schema_number(Connection& database) { return database.integer("PRAGMA user_version"); }

/// The journal's lines for one commit: these rows, then the marks that the batch is ready and kept
/// (committed).
std::string batch(const std::string& rows, std::int64_t number) {
  return rows + ready_line(number) + kept_line(number);
}

bool is_response(const Row& row) { return row.table->name == std::string("response"); }

[[noreturn]] void throw_ahead(const fs::path& database, const Comparison& found) {
  throw base::Error(
      database.string(),
      "is not the database that " + journal_beside(database).filename().string() +
          " belongs to, or lost a part of its data: " + words_of(found),
      "vip-study salvage --db " + database.string() +
          " --into NEW.db puts both together; if the journal is of another study, move it away");
}

/// True if `row` marks a presentation as played to its end, but the database lacks some of its frames. These
/// frames were lost with the program, because the journal contains no frames.
bool lacks_frames(Connection& database, const Row& row) {
  if (row.table->name != std::string("presentation") || journal::column(row, "state") != "played")
    return false;
  Statement lacks(database,
                  "SELECT (SELECT count(*) FROM frame WHERE presentation_id = CAST(?1 AS INTEGER)) "
                  "< CAST(?2 AS INTEGER)");
  return lacks.bind_all(row.key, journal::column(row, "frames")).step() && lacks.integer(0) == 1;
}

/// Writes the rows of an interrupted commit into the database. Omits the row of a presentation whose frames
/// were lost: the presentation is later marked as interrupted.
void take_over(Connection& database, const JournalRows& pending) {
  for (const auto& [key, row] : pending) {
    const auto now = journal::stands_as(database, row);
    if ((now && now->line == row.line) || lacks_frames(database, row)) continue;
    if (journal::put(database, row, journal::Put::Replace)) continue;
    throw base::Error(
        database.path().string(),
        "the last commit cannot be finished with this row of the journal of answers: " +
            row.line.substr(0, 200),
        "make a sound copy: vip-study salvage --db " + database.path().string() + " --into NEW.db");
  }
}

/// Finishes withdrawals that the journal announces, whose commit may not have happened.
void finish_withdrawals(Connection& database, const std::vector<std::string>& persons) {
  Statement row(database, "SELECT participant FROM session WHERE person = ? LIMIT 1");
  for (const std::string& person : persons) {
    if (!row.bind_all(person).step()) continue;
    const std::string participant = row.text(0);
    row.reset();
    bury(database, person, schema_number(database));
    ChorePlan plan(database);
    plan.forget(person, participant);
    plan.rewrite();
  }
}

Settled written_anew(Connection& database, std::set<std::string> gaze_deleted) {
  rewrite_journal(database);
  return {1, std::move(gaze_deleted)};
}

}  // namespace

std::string head_for(Connection& database) { return journal_head(schema_number(database)); }

Comparison compare(Connection& database, const JournalRows& kept) {
  Comparison found;
  found.lost = static_cast<std::int64_t>(kept.size());
  for (const auto& [key, row] : kept) found.answers += is_response(row) ? 1 : 0;
  for (const Table& table : journal::tables()) {
    journal::each_row(database, table, [&](const Row& row) {
      const auto before = kept.find({row.table, row.key});
      const bool same = before != kept.end() && before->second.line == row.line;
      if (!same) found.news += row.line + '\n';
      if (before == kept.end()) return;
      --found.lost;
      if (!is_response(row)) return;
      --found.answers;
      if (!same) ++found.different;
    });
  }
  return found;
}

bool is_ahead(const Comparison& found, const JournalContent& content, Connection& database) {
  const bool upgraded = content.schema > 0 && content.schema < schema_number(database);
  return found.lost > 0 || (found.different > 0 && !upgraded);
}

std::string words_of(const Comparison& found) {
  if (found.lost == 0) return std::to_string(found.different) + " answers differ from the journal";
  return std::to_string(found.answers) + " answers and " + std::to_string(found.lost - found.answers) +
         " other rows are in the journal only";
}

std::set<std::string> finish_what_was_begun(Connection& database, const JournalContent& content) {
  // A torn batch has unreadable lines: it was not completely on disk at a power cut, so its commit had not
  // begun. Ignore it.
  if (!content.rewriting && !content.torn) take_over(database, content.pending);
  if (content.rewriting) finish_withdrawals(database, content.forgotten);
  return delete_refused_gaze(database);
}

namespace {

Settled bring_together(Connection& database, JournalFile& file) {
  JournalContent content = read_journal(file.path());
  if (content.torn) content.pending.clear();
  const bool anew = !content.exists || content.rewriting;
  Comparison found;
  if (!anew) {
    found = compare(database, content.kept);
    if (is_ahead(found, content, database)) throw_ahead(database.path(), found);
  }
  Transaction transaction(database);
  std::set<std::string> gaze_deleted = finish_what_was_begun(database, content);
  transaction.commit();
  const bool upgraded = content.schema > 0 && content.schema < schema_number(database);
  if (anew || upgraded) return written_anew(database, std::move(gaze_deleted));
  if (!content.pending.empty()) {
    for (auto& [key, row] : content.pending) content.kept.insert_or_assign(key, std::move(row));
    found = compare(database, content.kept);
  }
  file.cut(content.end);
  std::string marks = content.pending.empty() ? "" : kept_line(content.last_number);
  if (!found.news.empty()) marks += batch(found.news, ++content.last_number);
  if (!marks.empty()) file.append(marks, head_for(database), true);
  return {content.last_number, std::move(gaze_deleted)};
}

}  // namespace

Settled settle(Connection& database, JournalFile& file) {
  Settled settled = bring_together(database, file);
  remove_journal_draft(file.path());
  database.keep_log(false);  // the journal has all rows of SQLite's log, so the log may change
  return settled;
}

std::vector<std::string> settle_before_writing(Connection& database) {
  JournalFile file(journal_beside(database.path()));
  return name_gaze_elsewhere(database, settle(database, file).gaze_deleted);
}

void rewrite_journal(Connection& database) {
  std::string rows;
  for (const Table& table : journal::tables())
    journal::each_row(database, table, [&](const Row& row) { rows += row.line + '\n'; });
  replace_journal(journal_beside(database.path()), rows.empty() ? "" : head_for(database) + batch(rows, 1));
}

}  // namespace study
