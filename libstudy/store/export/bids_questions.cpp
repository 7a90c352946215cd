/// Exports questions and questionnaires to BIDS.
#include <algorithm>
#include <map>
#include <sstream>

#include "libstudy/protocol/question.hpp"
#include "libstudy/store/export/bids_writer.hpp"
#include "libstudy/store/export/sickness_table.hpp"

namespace study::bids {

using sqlite::Connection;
using sqlite::Statement;

namespace {

/// Texts that name a page in the columns of an exported table.
struct Page {
  /// prefix: begins the names of the page's columns; words: follow the columns' meanings, in brackets
  std::string prefix, words;
};

/// The names of the `time`-th page (from 1) of a block in a session. An empty `block` means the session as a
/// whole. The prefix has a hyphen before `time`, which makes it distinct from the prefix of every other
/// block, because a block's id has no hyphen.
Page page_of(const LabelledSession& session, const std::string& block, int time = 1) {
  Page page{session.session + "_", "session ses-" + session.session};
  if (block.empty()) return page;
  const std::string again = time > 1 ? std::to_string(time) : "";
  page.prefix += block + (time > 1 ? "-" + again : "") + "_";
  page.words += ", page " + block + (time > 1 ? ", time " + again : "");
  return page;
}

/// A table with all pages of one questionnaire: one line per participant, and columns for each page that is
/// done in at least one session.
class Questionnaire {
 public:
  /// Adds the answers of a participant on one page. `asked` and `answers` have the same order.
  void add_page(const std::string& subject, const Page& page, const std::vector<Item>& asked,
                const std::vector<std::string>& answers) {
    for (std::size_t i = 0; i < asked.size(); ++i) {
      const std::string column = page.prefix + asked[i].code;
      if (!meaning_.contains(column)) {
        columns_.push_back(column);
        meaning_[column] = question_column(asked[i]);
        meaning_[column]["Description"] = asked[i].wording + " (" + page.words + ")";
      }
      answers_[subject][column] = answers[i];
    }
  }

  void write(const std::string& name, const std::vector<std::string>& subjects, Writer& writer) {
    Table table{{"participant_id"}};
    table[0].insert(table[0].end(), columns_.begin(), columns_.end());
    for (const std::string& subject : subjects) {
      auto& row = table.emplace_back(std::vector<std::string>{"sub-" + subject});
      for (const std::string& column : columns_) {
        const std::string& answer = answers_[subject][column];
        row.push_back(answer.empty() ? "n/a" : answer);
      }
    }
    writer.table("phenotype/" + name + ".tsv", table);
    writer.json("phenotype/" + name + ".json", meaning_);
  }

 private:
  std::vector<std::string> columns_;
  std::map<std::string, std::map<std::string, std::string>> answers_;  // by participant label, then column
  Json meaning_{{"MeasurementToolMetadata", described("pages of a vip-study protocol")}};
};

/// The answers on the SSQ page at a position of a session; nullptr if there are none.
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

/// Appends the SSQ scores of a page to the lists of its items and answers; "n/a" if `page` is nullptr.
void add_scores(const SsqPage* page, std::vector<Item>& asked, std::vector<std::string>& answers) {
  for (const SicknessColumn& column : ssq_score_columns())
    asked.push_back({0, column.name, column.meaning, ""});
  for (const std::string& score : ssq_texts(page ? page->answers : stats::SsqAnswers{}))
    answers.push_back(field(score));
}

/// Adds the session's lines of fms_summary_table(); the table's last four columns are block and three
/// numbers.
void add_fms(const SicknessTable& summary, const LabelledSession& session, Questionnaire& tool) {
  const std::size_t block = summary.columns.size() - 4;
  std::vector<Item> columns;
  for (std::size_t i = block + 1; i < summary.columns.size(); ++i)
    columns.push_back({0, summary.columns[i].name, summary.columns[i].meaning, ""});
  for (const auto& row : summary.rows) {
    if (row[0] != std::to_string(session.id)) continue;
    tool.add_page(session.subject, page_of(session, row[block]), columns, {row.end() - 3, row.end()});
  }
}

/// True if answers to questions of this kind (AnswerKindTraits::stored_word) are scores.
bool scored(const std::string& word) {
  return std::any_of(answer_kinds().begin(), answer_kinds().end(),
                     [&](const AnswerKindTraits& one) { return one.stored_word() == word && one.scored; });
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
                "SELECT DISTINCT q.question_id, q.code, q.wording, q.anchors, q.kind FROM question q "
                "JOIN ask k USING (question_id) JOIN session s ON s.protocol_id = q.protocol_id "
                "JOIN unit u ON u.session_id = s.session_id AND u.block = k.block "
                "WHERE s.session_id = ? AND q.personal = 0 AND " +
                    of + " ORDER BY q.question_id");
  row.bind_all(session);
  std::vector<Item> found;
  while (row.step()) {
    if (scored(row.text(4))) found.push_back({row.integer(0), row.text(1), row.text(2), row.text(3)});
  }
  return found;
}

std::pair<std::string, std::string> answer_of(Connection& database, std::int64_t unit, std::int64_t question,
                                              std::int64_t attempt) {
  Statement row(
      database,
      "SELECT score, response_time_s FROM response WHERE unit_id = ? AND question_id = ? AND attempt = ?");
  if (!row.bind_all(unit, question, attempt).step()) return {"n/a", "n/a"};
  return {field(row, 0), field(row, 1)};
}

void write_phenotypes(Connection& database, const std::vector<LabelledSession>& sessions, Writer& writer) {
  const auto sickness = read_sickness(database);
  const SicknessTable summary = fms_summary_table(sickness);
  Labels labels;
  std::map<std::string, Questionnaire> tools;
  std::vector<std::string> subjects;
  for (const LabelledSession& session : sessions) {
    if (subjects.empty() || subjects.back() != session.subject) subjects.push_back(session.subject);
    std::map<std::string, int> times;
    Statement unit(
        database,
        "SELECT unit_id, block, kind, position FROM unit WHERE session_id = ? AND trial_id IS NULL "
        "AND state = 'done' AND kind NOT IN ('practice', 'stimulus', 'repeat') ORDER BY position");
    for (unit.bind_all(session.id); unit.step();) {
      const std::string block = unit.text(1), kind = unit.text(2);
      auto asked = items(database, session.id, "u.unit_id = " + unit.text(0));
      if (asked.empty()) continue;
      std::vector<std::string> answers;
      for (const Item& item : asked)
        answers.push_back(answer_of(database, unit.integer(0), item.id, 0).first);
      if (kind == "ssq") add_scores(ssq_page(sickness, session.id, unit.integer(3)), asked, answers);
      tools[labels.of(kind == "ssq" || kind == "fms" ? kind : block)].add_page(
          session.subject, page_of(session, block, ++times[block]), asked, answers);
    }
    const bool any = std::any_of(sickness.begin(), sickness.end(), [&](const SicknessSession& one) {
      return one.id == session.id && !one.fms.empty();
    });
    if (any) add_fms(summary, session, tools[labels.of("fms_summary")]);
  }
  for (auto& [name, tool] : tools) tool.write(name, subjects, writer);
}

}  // namespace study::bids
