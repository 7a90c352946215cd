#include "libstudy/store/export/sickness_table.hpp"

#include <algorithm>

#include "libstudy/protocol/question.hpp"
#include "stats/inference/describe.hpp"

namespace study {

namespace {

const std::vector<SicknessColumn> ssq_session_columns{
    {"session_id", "INTEGER", "session"},
    {"participant", "TEXT", "participant code"},
    {"visit", "INTEGER", "visit of the participant under the protocol"},
    {"test_data", "INTEGER", "1: never pooled with real data"},
    {"observer", "TEXT", "simulated observer that answered; empty: a person"}};

std::vector<std::string> session_fields(const SicknessSession& session) {
  return {std::to_string(session.id), session.participant, std::to_string(session.visit),
          session.test_data ? "1" : "0", session.observer};
}

SicknessTable table_of(const std::string& name, const std::vector<SicknessColumn>& columns) {
  SicknessTable table{name, ssq_session_columns, {}};
  table.columns.insert(table.columns.end(), columns.begin(), columns.end());
  return table;
}

std::vector<SicknessColumn> ssq_columns() {
  std::vector<SicknessColumn> columns{
      {"unit_position", "INTEGER", "order of the page in the session, from 0"},
      {"block", "TEXT", "id of its block in the protocol"},
      {"occasion", "TEXT", "before: before the session's first trial; after: later"},
      {"answered_utc", "TEXT", "when"}};
  for (const Question& item : ssq_questions("en"))
    columns.push_back({item.id, "INTEGER", item.text + ": 0 none, 1 slight, 2 moderate, 3 severe"});
  for (const SicknessColumn& column : ssq_score_columns()) columns.push_back(column);
  return columns;
}

SicknessTable ssq_table(std::span<const SicknessSession> sessions) {
  SicknessTable table = table_of("ssq", ssq_columns());
  for (const SicknessSession& session : sessions) {
    for (const SsqPage& page : session.ssq) {
      auto& row = table.rows.emplace_back(session_fields(session));
      for (const std::string& field : {std::to_string(page.position), page.block,
                                       std::string(page.before ? "before" : "after"), page.answered_utc})
        row.push_back(field);
      for (const std::optional<int>& answer : page.answers)
        row.push_back(answer ? std::to_string(*answer) : "");
      for (const std::string& score : ssq_texts(page.answers)) row.push_back(score);
    }
  }
  return table;
}

SicknessTable fms_table(std::span<const SicknessSession> sessions) {
  SicknessTable table = table_of(
      "fms", {{"unit_position", "INTEGER", "order of the page or trial in the session, from 0"},
              {"block", "TEXT", "id of its block in the protocol"},
              {"trial_position", "INTEGER", "order among the session's trials, from 0; empty: a page"},
              {"minutes", "REAL", "since the session's first answer, min"},
              {"answered_utc", "TEXT", "when"},
              {"fms", "INTEGER", "Fast Motion Sickness scale (Keshavarz and Hecht 2011), 0 to 20"}});
  for (const SicknessSession& session : sessions) {
    for (const FmsAnswer& answer : session.fms) {
      auto& row = table.rows.emplace_back(session_fields(session));
      for (const std::string& field :
           {std::to_string(answer.position), answer.block, answer.trial ? std::to_string(*answer.trial) : "",
            number_text(answer.minutes), answer.answered_utc, std::to_string(answer.score)})
        row.push_back(field);
    }
  }
  return table;
}

/// A line of the table "fms_summary" about a block, or about the whole session if `block` is empty.
std::vector<std::string> summary_row(const SicknessSession& session, const std::string& block) {
  std::vector<double> scores;
  for (const FmsAnswer& answer : session.fms) {
    if (block.empty() || answer.block == block) scores.push_back(answer.score);
  }
  const auto summary = stats::describe(scores);
  auto row = session_fields(session);
  for (const std::string& field :
       {block, std::to_string(scores.size()), number_text(summary->mean), number_text(summary->max)})
    row.push_back(field);
  return row;
}

/// The fields of a row as CSV fields. Texts are guarded against formulas; numbers need no guard.
std::vector<std::string> csv_fields(const SicknessTable& table, const std::vector<std::string>& row,
                                    const CsvDialect& dialect) {
  std::vector<std::string> fields;
  for (std::size_t i = 0; i < row.size(); ++i)
    fields.push_back(table.columns[i].type == "TEXT" ? csv_field(row[i], dialect)
                                                     : csv_number(row[i], dialect));
  return fields;
}

}  // namespace

std::vector<SicknessColumn> ssq_score_columns() {
  std::vector<SicknessColumn> columns;
  for (const stats::SsqScale scale : stats::ssq_scales) {
    columns.push_back({std::string("ssq_") + stats::ssq_name(scale), "REAL",
                       "SSQ score (Kennedy et al. 1993), " + number_text(stats::ssq_weight(scale)) +
                           " times the sum of its items; empty: one of them was left out"});
  }
  return columns;
}

std::vector<std::string> ssq_texts(const stats::SsqAnswers& answers) {
  std::vector<std::string> texts;
  for (const stats::SsqScale scale : stats::ssq_scales) {
    const auto score = stats::ssq_score(scale, answers);
    texts.push_back(score ? number_text(*score) : "");
  }
  return texts;
}

SicknessTable fms_summary_table(std::span<const SicknessSession> sessions) {
  SicknessTable table =
      table_of("fms_summary", {{"block", "TEXT", "id of a block in the protocol; empty: the whole session"},
                               {"fms_answers", "INTEGER", "answers on the Fast Motion Sickness scale"},
                               {"fms_mean", "REAL", "their mean"},
                               {"fms_peak", "REAL", "the largest of them"}});
  for (const SicknessSession& session : sessions) {
    if (session.fms.empty()) continue;
    std::vector<std::string> blocks{""};
    for (const FmsAnswer& answer : session.fms) {
      if (std::find(blocks.begin(), blocks.end(), answer.block) == blocks.end())
        blocks.push_back(answer.block);
    }
    for (const std::string& block : blocks) table.rows.push_back(summary_row(session, block));
  }
  return table;
}

std::vector<SicknessTable> sickness_tables(std::span<const SicknessSession> sessions) {
  return {ssq_table(sessions), fms_table(sessions), fms_summary_table(sessions)};
}

std::int64_t write_sickness(const SicknessTable& table, const ExportDraft& draft, const std::string& name) {
  ExportFile file(draft, name);
  std::vector<std::string> names;
  for (const SicknessColumn& column : table.columns) names.push_back(column.name);
  file.write(csv_head(names, draft.dialect()));
  for (const auto& row : table.rows)
    file.write(csv_line(csv_fields(table, row, draft.dialect()), draft.dialect()));
  file.finish();
  return static_cast<std::int64_t>(table.rows.size());
}

}  // namespace study
