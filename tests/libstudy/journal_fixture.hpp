#pragma once
/// A small study with every kind of row that the journal has, and readers that compare the journal with the
/// database.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "libstudy/store/answer_journal.hpp"
#include "libstudy/store/file/database.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study::test {

inline const OpenUnit& unit_at(const OpenSession& session, int position) {
  for (const OpenUnit& unit : session.units) {
    if (unit.plan.position == position) return unit;
  }
  throw std::logic_error("the unit is done");
}

/// Two people under pairs(): answered pages and trials, an interrupted trial, a repeated one, an excluded
/// one, notes; P02 stopped early.
inline void write_small_study(const std::filesystem::path& path) {
  Store store(path, sqlite::Open::Create);
  store.add_run(run_plan(pairs(), {"P01", "P02"}));
  const auto sessions = store.open_runs().at(0).sessions;
  for (const OpenSession& session : sessions) {
    const bool first = session.plan.participant == "P01";
    const KeptAnswer games{"games", {score(first ? 1 : 0), 1.0 / 3}};
    store.answer(session.id, session.units.at(0), 0, {&games, 1}, true, 5);
    for (int i = 1; i < 4; ++i) {
      const OpenUnit& unit = session.units.at(static_cast<std::size_t>(i));
      const int attempt = show(store, session, unit);
      const std::vector<KeptAnswer> kept{{"preference", {score(1 + i % 2), 0.1}},
                                         {"ease", {score(1 + i), 2.5}}};
      store.answer(session.id, unit, attempt, kept, true, 6);
    }
    store.note(session.id, session.units.at(1).id, first ? "a loud \"street\"\nand rain" : "calm");
    if (first) continue;
    store.end_session(session.id, {EarlyEnd::Stopped, "felt unwell"}, 9);
  }
  const OpenSession session = store.open_runs().at(0).sessions.at(0);
  const OpenUnit& cut = session.units.at(0);
  store.begin_presentation(session.id, cut.trial_id, 1, 0, cut.trial->first, 77);
  const std::int64_t shown = cut.trial_id - 1;
  store.repeat_trial(session.id, shown, "sneezed");
  store.exclude_trial(session.id, shown - 1, "phone rang");
  const auto units = store.open_runs().at(0).sessions.at(0).units;
  for (const OpenUnit& again : units) {
    if (again.trial_id != shown) continue;
    const KeptAnswer ease{"ease", {score(7), 2}};
    store.answer(session.id, again, show(store, session, again), {&ease, 1}, true, 7);
  }
}

/// The lines that the journal should have for the database, sorted.
inline std::vector<std::string> lines_of(const std::filesystem::path& path) {
  std::vector<std::string> lines;
  const auto database = open_database(path, sqlite::Open::Read, read_schema_steps());
  for (const journal::Table& table : journal::tables())
    journal::each_row(*database, table, [&](const journal::Row& row) { lines.push_back(row.line); });
  std::sort(lines.begin(), lines.end());
  return lines;
}

/// The committed lines of the journal beside the database, sorted.
inline std::vector<std::string> kept_lines(const std::filesystem::path& path) {
  std::vector<std::string> lines;
  for (const auto& [key, row] : read_journal(journal_beside(path)).kept) lines.push_back(row.line);
  std::sort(lines.begin(), lines.end());
  return lines;
}

inline void expect_journal_equals(const std::filesystem::path& path) {
  EXPECT_EQ(kept_lines(path), lines_of(path));
  EXPECT_TRUE(read_journal(journal_beside(path)).pending.empty());
}

/// Every answer as text: participant, position, attempt, question, value, response time, UTC.
inline std::vector<std::string> answers_of(const std::filesystem::path& path) {
  std::vector<std::string> all;
  const auto database = open_database(path, sqlite::Open::Read, read_schema_steps());
  sqlite::Statement row(
      *database,
      "SELECT s.participant || ' ' || u.position || ' ' || r.attempt || ' ' || q.code || ' ' || "
      "coalesce(r.score, r.words, '-') || ' ' || format('%!.17g', r.response_time_s) || ' ' || "
      "r.answered_utc FROM response r JOIN unit u USING (unit_id) JOIN session s USING (session_id) "
      "JOIN question q USING (question_id) ORDER BY 1");
  while (row.step()) all.push_back(row.text(0));
  return all;
}

}  // namespace study::test
