#include "libstudy/store/import/table_reader.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "libstudy/store/import/source_time.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/json_problems.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace fs = std::filesystem;

namespace {

constexpr int most_visits = 10000;
constexpr double longest_time_s = 1e7;
constexpr double slowest_fps = 1e-9;

bool has(const std::vector<std::string>& list, const std::string& one) {
  return std::find(list.begin(), list.end(), one) != list.end();
}

}  // namespace

TableReader::TableReader(const Protocol& protocol, const ImportMapping& mapping,
                         const std::vector<const Question*>& asked, const SourceTable& table, Visits& visits)
    : mapping_(mapping), table_(table), visits_(visits), rows_(placed(mapping.rows)) {
  for (const StimulusColumns* one : mapping.stimuli()) stimuli_.push_back(placed_stimulus(protocol, *one));
  for (const auto& [key, column] : mapping.columns) places_[key] = table.place_of(column);
  if (!mapping.onset.column.empty()) onset_ = table.place_of(mapping.onset.column);
  for (const AnswerColumn& one : mapping.answers) {
    PlacedAnswer answer{&one, nullptr, table.place_of(one.column), {}, placed(one.when)};
    for (const Question* question : asked)
      if (question->id == one.question) answer.question = question;
    if (!one.response_time_column.empty()) answer.response_time = table.place_of(one.response_time_column);
    for (const std::string& column : one.choice_of) answer.choice_of.push_back(table.place_of(column));
    if (!answer.choice_of.empty() && !mapping.pairs())
      throw base::Error("[[answer]] of question '" + one.question + "' in the mapping",
                        "has choice_of, and the mapping's trials show one stimulus",
                        "name the columns of both stimuli under [columns.first] and [columns.second]");
    answers_.push_back(std::move(answer));
  }
}

TableReader::PlacedStimulus TableReader::placed_stimulus(const Protocol& protocol,
                                                         const StimulusColumns& columns) const {
  PlacedStimulus out{CellMatch(protocol, mapping_.stimulus, columns, table_), {}, columns.frames_file};
  for (const StimulusColumns* one : {&mapping_.stimulus, &columns})
    for (const auto& [key, column] : one->columns)
      if (key.starts_with("shown_")) out.stated[key] = table_.place_of(column);
  return out;
}

TableReader::Conditions TableReader::placed(const std::vector<RowCondition>& conditions) const {
  Conditions out;
  for (const RowCondition& one : conditions) out.emplace_back(table_.place_of(one.column), &one);
  return out;
}

ReadSource TableReader::read() {
  ReadSource out{table_.file(), table_.sha256(), table_.rows().size(), 0, left_columns()};
  for (const Row& row : table_.rows()) {
    if (!takes(rows_, row)) continue;
    ++out.used;
    add(row, out.used);
  }
  if (out.used == 0)
    throw base::Error(table_.file().string(), "has no row that the mapping takes as a trial",
                      "correct the [[row]] tables of the mapping, or leave the file out");
  return out;
}

bool TableReader::takes(const Conditions& conditions, const Row& row) {
  return std::all_of(conditions.begin(), conditions.end(), [&](const auto& one) {
    const std::string& text = row.fields[one.first];
    return one.second->is.empty() ? !text.empty() : has(one.second->is, text);
  });
}

std::vector<std::string> TableReader::left_columns() const {
  std::set<std::string> used{mapping_.onset.column};
  for (const auto& [key, column] : mapping_.columns) used.insert(column);
  std::string files;
  for (const StimulusColumns* one : {&mapping_.stimulus, &mapping_.first, &mapping_.second}) {
    for (const auto& [key, column] : one->columns) used.insert(column);
    for (const auto& [key, column] : one->factors) used.insert(column);
    files += one->frames_file + "\n";
  }
  for (const RowCondition& one : mapping_.rows) used.insert(one.column);
  for (const AnswerColumn& one : mapping_.answers) {
    used.insert({one.column, one.response_time_column});
    used.insert(one.choice_of.begin(), one.choice_of.end());
    for (const RowCondition& condition : one.when) used.insert(condition.column);
  }
  std::vector<std::string> out;
  for (const std::string& name : table_.names())
    if (!used.contains(name) && files.find("{" + name + "}") == std::string::npos) out.push_back(name);
  return out;
}

std::optional<std::size_t> TableReader::place(const char* key) const {
  const auto found = places_.find(key);
  if (found == places_.end()) return {};
  return found->second;
}

std::string TableReader::code_in(const Row& row) const {
  std::string code = mapping_.only_person;
  if (const auto at = place("person")) code = row.fields[*at];
  try {
    check_participant_code(code);
  } catch (const base::Error& error) {
    throw base::Error(table_.place(row), error.what(), "");
  }
  return code;
}

Visit& TableReader::visit_of(const Row& row) {
  const std::string code = code_in(row);
  const auto visit_at = place("visit");
  const int number = visit_at ? whole_number_in(table_, row, *visit_at, 1, most_visits) : 1;
  auto [found, fresh] = visits_.try_emplace({code, number});
  Visit& out = found->second;
  if (fresh) {
    out.file = table_.file();
    out.session.participant = code;
    out.session.visit = number;
    out.session.source_sha256 = table_.sha256();
    out.session.observer = observer_of(row);
    out.session.test_data = is_test(row);
    if (const auto at = place("started"))
      out.session.started_utc = utc_in(table_, row, *at, mapping_.utc_offset);
  } else if (out.file != table_.file()) {
    throw base::Error(
        table_.place(row),
        "is of visit " + std::to_string(number) + " of " + code + ", which " + out.file.string() +
            " holds too",
        "name the column of the visit in the mapping, leave one of the files out, or write another "
        "participant code if it is another person");
  } else if (observer_of(row) != out.session.observer || is_test(row) != out.session.test_data) {
    throw base::Error(table_.place(row), "differs from earlier rows of " + code + " in observer or test data",
                      "correct the row: both hold for a whole visit");
  }
  return out;
}

std::optional<std::string> TableReader::observer_of(const Row& row) const {
  const auto at = place("observer");
  if (!at || row.fields[*at].empty()) return {};
  return row.fields[*at];
}

bool TableReader::is_test(const Row& row) const {
  const auto at = place("test_data");
  return mapping_.test_data || (at && whole_number_in(table_, row, *at, 0, 1) == 1);
}

void TableReader::add(const Row& row, std::size_t number) {
  Visit& visit = visit_of(row);
  const auto order_at = place("order");
  const double order = order_at ? number_in(table_, row, *order_at) : static_cast<double>(number);
  std::vector<int> cells;
  for (const PlacedStimulus& one : stimuli_) cells.push_back(one.match.cell_of(row));
  const auto known = visit.trials.find(order);
  if (known != visit.trials.end() && known->second.trial.cells() != cells)
    fail_at_field(table_, row, *order_at,
                  "is the number of another trial of " + visit.session.participant + ", which begins at " +
                      known->second.place + " with another setting",
                  "correct the rows, or name the column of the visit in the mapping");
  PlacedTrial& trial =
      known != visit.trials.end()
          ? known->second
          : visit.trials.emplace(order, PlacedTrial{new_trial(row, cells), table_.place(row)}).first->second;
  bool any = false;
  for (const PlacedAnswer& answer : answers_) {
    if (!takes(answer.when, row)) continue;
    any = true;
    add_answer(trial.trial, answer, row);
  }
  if (!any)
    throw base::Error(table_.place(row), "holds no answer by the [[answer]] tables of the mapping",
                      "add an [[answer]] for it, or leave the row out by a [[row]]");
}

ImportedTrial TableReader::new_trial(const Row& row, const std::vector<int>& cells) const {
  ImportedTrial out;
  if (const auto at = place("answered")) out.utc = utc_in(table_, row, *at, mapping_.utc_offset);
  for (std::size_t i = 0; i < cells.size(); ++i) out.showings.push_back(showing(row, stimuli_[i], cells[i]));
  out.showings.front().at_ns = onset_in(row);
  return out;
}

ImportedShowing TableReader::showing(const Row& row, const PlacedStimulus& stimulus, int cell) const {
  ImportedShowing out;
  out.cell = cell;
  out.stated = {stated(stimulus, "shown_mean_fps", row, slowest_fps),
                stated(stimulus, "shown_mean_arithmetic_fps", row, slowest_fps),
                stated(stimulus, "shown_sd_fps", row, 0)};
  const bool whole = out.stated.mean.has_value();
  if (out.stated.mean_arithmetic.has_value() != whole || out.stated.sd.has_value() != whole)
    throw base::Error(
        table_.place(row), "states only a part of the frame rate that was shown",
        "give shown_mean_fps (harmonic), shown_mean_arithmetic_fps and shown_sd_fps, or none of them");
  add_frames(out, stimulus.frames_file, row);
  return out;
}

std::optional<std::int64_t> TableReader::onset_in(const Row& row) const {
  if (!onset_ || row.fields[*onset_].empty()) return {};
  const double seconds = number_in(table_, row, *onset_) * mapping_.onset.unit_s;
  if (seconds < 0 || seconds > longest_time_s)
    fail_at_field(table_, row, *onset_, "is no onset", "correct the row, or the column in the mapping");
  return std::llround(1e9 * seconds);
}

std::optional<double> TableReader::stated(const PlacedStimulus& stimulus, const char* key, const Row& row,
                                          double least) const {
  const auto found = stimulus.stated.find(key);
  if (found == stimulus.stated.end() || row.fields[found->second].empty()) return {};
  const double value = number_in(table_, row, found->second);
  if (value < least)
    fail_at_field(table_, row, found->second, "is no frame rate",
                  "correct the row, or the column in the mapping");
  return value;
}

void TableReader::add_frames(ImportedShowing& showing, const std::string& frames_file, const Row& row) const {
  if (frames_file.empty()) return;
  std::string path = frames_file;
  for (std::size_t i = 0; i < table_.names().size(); ++i) {
    const std::string name = "{" + table_.names()[i] + "}";
    for (auto at = path.find(name); at != std::string::npos; at = path.find(name, at + row.fields[i].size()))
      path.replace(at, name.size(), row.fields[i]);
  }
  const fs::path file = table_.file().parent_path() / path;
  if (!fs::is_regular_file(file)) {
    if (mapping_.frames_may_lack) return;
    throw base::Error(
        table_.place(row), "has no frame log: " + file.string() + " is missing",
        "put it there, correct `file` in [frames], or write may_lack = true in [frames], so that the "
        "timing of such trials counts as not recorded");
  }
  // Of the columns of one window, the changes of the picture are the better evidence.
  showing.frames = read_frame_log(file, mapping_.frames_column, Intervals::DisplayChanges);
  showing.frames_sha256 = base::sha256_of_file(file);
}

/// The text of an answer; empty if it stands for no answer.
std::string TableReader::text_of(const PlacedAnswer& answer, const Row& row) const {
  std::string text = row.fields[answer.column];
  if (has(mapping_.missing, text)) return "";
  if (const std::string& key = answer.what->key; !key.empty()) {
    const base::Json json = base::parse_json(text);
    if (!json.is_object() || !json.contains(key))
      fail_at_field(table_, row, answer.column, "is no JSON object with \"" + key + "\"",
                    "correct `key` of the [[answer]], or leave the row out by a [[row]]");
    if (const auto twice = base::repeated_key(text))
      fail_at_field(table_, row, answer.column,
                    "has the key \"" + base::shortened(twice->key, 60) + "\" twice in one object",
                    "correct the row: which of the two values holds is not known");
    const base::Json& value = json[key];
    text = value.is_string() ? value.get<std::string>() : value.dump();
    if (has(mapping_.missing, text)) return "";
  }
  if (text.empty())
    fail_at_field(
        table_, row, answer.column, "is no answer",
        "leave the row out by a [[row]], or list \"\" under `missing`, so that it counts as a trial "
        "without an answer");
  return text;
}

int TableReader::score_in(const PlacedAnswer& answer, const Row& row, const std::string& text) const {
  const auto& scores = answer.what->scores;
  const Question& question = *answer.question;
  std::optional<int> score;
  if (!scores.empty()) {
    if (const auto found = scores.find(text); found != scores.end()) score = found->second;
  } else if (const auto number = base::parse_number<double>(text);
             number && *number == std::floor(*number) && std::abs(*number) < 1e6) {
    score = static_cast<int>(*number) + answer.what->add;
  }
  if (!score || !can_be_given(question, *score))
    fail_at_field(
        table_, row, answer.column,
        "is no answer to question '" + question.id + "', which takes " + std::to_string(question.scale_min) +
            " to " + std::to_string(question.scale_max),
        "correct the row, or the [[answer]]: `add` shifts numbers, and `scores` gives texts their scores");
  return *score;
}

/// 1 if the answer names what was shown first, 2 if it names what was shown second.
int TableReader::chosen_in(const PlacedAnswer& answer, const Row& row, const std::string& text) const {
  const bool first = row.fields[answer.choice_of[0]] == text,
             second = row.fields[answer.choice_of[1]] == text;
  const int score = first ? 1 : 2;
  if (first == second || !can_be_given(*answer.question, score))
    fail_at_field(table_, row, answer.column,
                  first && second ? "names both stimuli of the pair"
                  : first || second
                      ? "is a choice between two, which question '" + answer.question->id + "' is not"
                      : "names neither stimulus of the pair",
                  "correct the row, or the columns under choice_of of the [[answer]]");
  return score;
}

void TableReader::add_answer(ImportedTrial& trial, const PlacedAnswer& answer, const Row& row) const {
  for (const ImportedAnswer& one : trial.answers)
    if (one.question == answer.what->question)
      fail_at_field(table_, row, answer.column, "is a second answer to '" + one.question + "' in one trial",
                    "keep the answer that counts, or name the column that numbers the trials");
  ImportedAnswer out{answer.what->question, {}, {}};
  const std::string text = text_of(answer, row);
  if (!text.empty())
    out.score = answer.choice_of.empty() ? score_in(answer, row, text) : chosen_in(answer, row, text);
  if (out.score && answer.response_time && !row.fields[*answer.response_time].empty()) {
    const double seconds = number_in(table_, row, *answer.response_time) * answer.what->response_time_unit_s;
    if (seconds < 0 || seconds > longest_time_s)
      fail_at_field(table_, row, *answer.response_time, "is no response time",
                    "correct the row, or the column in the mapping");
    out.response_time_s = seconds;
  }
  trial.answers.push_back(out);
}

}  // namespace study
