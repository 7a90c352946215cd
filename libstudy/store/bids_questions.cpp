#include "libstudy/store/bids_questions.hpp"

#include <algorithm>
#include <map>
#include <sstream>

#include "libstudy/store/sickness_table.hpp"

namespace study::bids {

using sqlite::Connection;
using sqlite::Statement;

namespace {

/// All pages of one questionnaire: a table whose columns grow with what was asked.
class Questionnaire {
 public:
  void add_page(std::vector<std::string> key, const std::vector<Item>& asked,
                const std::vector<std::string>& answers) {
    for (std::size_t i = 0; i < asked.size(); ++i) {
      meaning_[asked[i].code] = question_column(asked[i]);
      const auto column = std::find(header_.begin(), header_.end(), asked[i].code);
      const auto place = static_cast<std::size_t>(column - header_.begin());
      if (column == header_.end()) header_.push_back(asked[i].code);
      key.resize(std::max(key.size(), place + 1), "n/a");
      key[place] = answers[i];
    }
    rows_.push_back(std::move(key));
  }

  void write(const std::string& name, Writer& writer) const {
    Table table{header_};
    for (auto row : rows_) {
      row.resize(header_.size(), "n/a");
      table.push_back(std::move(row));
    }
    writer.table("phenotype/" + name + ".tsv", table);
    writer.json("phenotype/" + name + ".json", meaning_);
  }

 private:
  std::vector<std::string> header_{"participant_id", "session_id", "block"};
  Table rows_;
  Json meaning_{{"MeasurementToolMetadata", described("pages of a vip-study protocol")},
                {"session_id", described("session")},
                {"block", described("page of the protocol")}};
};

/// The page of the SSQ at a place of a session; nullptr: it has no answers.
const SsqPage* ssq_page(const std::vector<SicknessSession>& sickness, std::int64_t session,
                        std::int64_t position) {
  for (const SicknessSession& one : sickness) {
    if (one.id != session) continue;
    for (const SsqPage& page : one.ssq) {
      if (page.position == position) return &page;
    }
  }
  return nullptr;
}

/// Puts the scores of an SSQ page behind its items.
void add_scores(const SsqPage* page, std::vector<Item>& asked, std::vector<std::string>& answers) {
  for (const SicknessColumn& column : ssq_score_columns())
    asked.push_back({0, column.name, column.meaning, ""});
  for (const std::string& score : ssq_texts(page ? page->answers : stats::SsqAnswers{}))
    answers.push_back(field(score));
}

/// The lines of a session in fms_summary_table(), whose last columns are the block and three numbers.
void add_fms(const SicknessTable& summary, const LabelledSession& session, Questionnaire& tool) {
  const std::size_t block = summary.columns.size() - 4;
  std::vector<Item> columns;
  for (std::size_t i = block + 1; i < summary.columns.size(); ++i)
    columns.push_back({0, summary.columns[i].name, summary.columns[i].meaning, ""});
  for (const auto& row : summary.rows) {
    if (row[0] != std::to_string(session.id)) continue;
    tool.add_page({"sub-" + session.subject, "ses-" + session.session, field(row[block])}, columns,
                  {row.end() - 3, row.end()});
  }
}

}  // namespace

Json question_column(const Item& item) {
  Json json = described(item.wording);
  std::istringstream lines(item.anchors);
  for (std::string line; std::getline(lines, line);) {
    const auto at = line.find(" = ");
    if (at != std::string::npos) json["Levels"][line.substr(0, at)] = line.substr(at + 3);
  }
  return json;
}

std::vector<Item> items(Connection& database, std::int64_t session, const std::string& of) {
  Statement row(database,
                "SELECT DISTINCT q.question_id, q.code, q.wording, q.anchors FROM question q "
                "JOIN ask k USING (question_id) JOIN session s ON s.protocol_id = q.protocol_id "
                "JOIN unit u ON u.session_id = s.session_id AND u.block = k.block "
                "WHERE s.session_id = ? AND q.personal = 0 AND q.kind <> 'text' AND " +
                    of + " ORDER BY q.question_id");
  row.bind(0, session);
  std::vector<Item> found;
  while (row.step()) found.push_back({row.integer(0), row.text(1), row.text(2), row.text(3)});
  return found;
}

std::pair<std::string, std::string> answer_of(Connection& database, std::int64_t unit, std::int64_t question,
                                              std::int64_t attempt) {
  Statement row(
      database,
      "SELECT score, response_time_s FROM response WHERE unit_id = ? AND question_id = ? AND attempt = ?");
  if (!row.bind(0, unit).bind(1, question).bind(2, attempt).step()) return {"n/a", "n/a"};
  return {field(row, 0), field(row, 1)};
}

void write_phenotypes(Connection& database, const std::vector<LabelledSession>& sessions, Writer& writer) {
  const auto sickness = read_sickness(database);
  const SicknessTable summary = fms_summary_table(sickness);
  Labels labels;
  std::map<std::string, Questionnaire> tools;
  for (const LabelledSession& session : sessions) {
    Statement unit(
        database,
        "SELECT unit_id, block, kind, position FROM unit WHERE session_id = ? AND trial_id IS NULL "
        "AND state = 'done' AND kind NOT IN ('practice', 'stimulus', 'repeat') ORDER BY position");
    for (unit.bind(0, session.id); unit.step();) {
      const std::string block = unit.text(1), kind = unit.text(2);
      auto asked = items(database, session.id, "u.unit_id = " + unit.text(0));
      if (asked.empty()) continue;
      std::vector<std::string> answers;
      for (const Item& item : asked)
        answers.push_back(answer_of(database, unit.integer(0), item.id, 0).first);
      if (kind == "ssq") add_scores(ssq_page(sickness, session.id, unit.integer(3)), asked, answers);
      tools[labels.of(kind == "ssq" || kind == "fms" ? kind : block)].add_page(
          {"sub-" + session.subject, "ses-" + session.session, field(block)}, asked, answers);
    }
  }
  for (const LabelledSession& session : sessions) {
    const bool any = std::any_of(sickness.begin(), sickness.end(), [&](const SicknessSession& one) {
      return one.id == session.id && !one.fms.empty();
    });
    if (any) add_fms(summary, session, tools[labels.of("fms_summary")]);
  }
  for (const auto& [name, tool] : tools) tool.write(name, writer);
}

}  // namespace study::bids
