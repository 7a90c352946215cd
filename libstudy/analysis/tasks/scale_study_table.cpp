#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "libstudy/analysis/task_data.hpp"
#include "libstudy/analysis/tasks/data_json.hpp"
#include "libstudy/analysis/tasks/scale_table.hpp"
#include "stats/base/error.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

/// What a stimulus was: the names of what a protocol varies, and their values.
using Attributes = std::vector<std::pair<std::string, std::string>>;

constexpr const char* scene_attribute = "scene";
constexpr const char* rate_attribute = "frame rate";

Attributes attributes_of(const TaskProtocol& protocol, const StimulusSpec& what, const FpsSetting& nominal,
                         int cell) {
  Attributes out;
  if (protocol.whole && !protocol.whole->design.factors.empty()) {
    const Design& design = protocol.whole->design;
    for (std::size_t f = 0; f < design.factors.size(); ++f)
      out.emplace_back(design.factors[f].name,
                       level_name(design, design.cells.at(static_cast<std::size_t>(cell)), f));
    return out;
  }
  out.emplace_back(scene_attribute, scene_name(what.scene));
  out.emplace_back("method", treatment_name(what));
  out.emplace_back("n_*", what.n_star);
  if (nominal.mean > 0)
    out.emplace_back(rate_attribute,
                     base::shortest(nominal.mean) + "/" + base::shortest(nominal.sd) + " frames/s");
  return out;
}

/// The stimuli and the answer of one trial.
struct ScaledTrial {
  std::string person;
  Attributes first, second;  ///< second: empty for a rating
  int score = 0;             ///< of a choice: 1 for the first, 2 for the second
};

bool is_rating(const ChosenTask& one) { return !one.protocol.pairs && traits_of(one.question.kind).rated(); }
bool is_choice(const ChosenTask& one) {
  return one.protocol.pairs && one.question.kind == AnswerKind::Choice && one.question.anchors.size() == 2;
}

/// The protocols and questions with choices or ratings that match the selection.
std::vector<ChosenTask> chosen_for_scale(const TaskStudy& study, const ScaleSelection& selection) {
  std::vector<ChosenTask> out;
  std::set<std::pair<std::string, std::string>> seen;
  std::vector<std::string> wanted = selection.questions, protocols = selection.protocols;
  wanted.insert(wanted.begin(), "");
  if (protocols.empty()) protocols.push_back("");
  for (const std::string& protocol : protocols)
    for (const std::string& question : wanted)
      for (const TaskKind kind : {TaskKind::Task2, TaskKind::Task1, TaskKind::Pilot, TaskKind::Own})
        if (const auto chosen = choose_tasks(study, {kind, protocol, {}, question}))
          for (const ChosenTask& one : *chosen)
            if ((is_rating(one) || is_choice(one)) &&
                seen.emplace(one.protocol.sha256, one.question.id).second)
              out.push_back(one);
  return out;
}

/// Keeps one question of each kind. base::Error if several match.
void keep_one_question(std::vector<ChosenTask>& out, const ScaleSelection& selection) {
  for (const auto is : {is_choice, is_rating}) {
    std::vector<std::string> ids;
    bool selected = false;
    for (const ChosenTask& one : out) {
      if (!is(one)) continue;
      if (std::find(ids.begin(), ids.end(), one.question.id) == ids.end()) ids.push_back(one.question.id);
      selected = selected || std::find(selection.questions.begin(), selection.questions.end(),
                                       one.question.id) != selection.questions.end();
    }
    if (ids.size() > 1 && !selected)
      throw base::Error(selection.database,
                        std::string("asks several questions ") +
                            (is == is_choice ? "with a choice between two" : "with a rating") +
                            ", which are never pooled",
                        "choose one with --question: " + base::joined(ids));
    if (selected)
      std::erase_if(out, [&](const ChosenTask& one) {
        return is(one) && std::find(selection.questions.begin(), selection.questions.end(),
                                    one.question.id) == selection.questions.end();
      });
  }
  for (const std::string& id : selection.questions)
    if (std::none_of(out.begin(), out.end(), [&](const ChosenTask& one) { return one.question.id == id; }))
      throw base::Error("--question " + base::shortened(id),
                        "is no question with a choice between two stimuli of a pair or a rating of one",
                        "leave it out, or give the id of such a question of the protocol");
}

/// Leaves out data without people, and test data, where others are of people.
void leave_out_unreal(std::vector<TaskData>& all, std::vector<std::string>& notes) {
  const auto drop = [&](auto unreal, const char* what) {
    if (std::all_of(all.begin(), all.end(), unreal)) return;
    std::erase_if(all, [&](const TaskData& data) {
      if (unreal(data))
        notes.push_back("protocol " + hashed_name(data.protocol) + " left out: it holds only " + what + ".");
      return unreal(data);
    });
  };
  drop([](const TaskData& data) { return data.test_data; }, "test data");
  drop([](const TaskData& data) { return data.simulated.size() >= data.participants.size(); },
       "answers of simulated observers");
}

/// base::Error if choices, or ratings, are of several protocols.
void check_one_protocol(const std::vector<TaskData>& all, const std::string& database) {
  for (const bool pairs : {true, false}) {
    std::vector<std::string> names;
    for (const TaskData& data : all)
      if (data.protocol.pairs == pairs) names.push_back(hashed_name(data.protocol));
    if (names.size() > 1)
      throw base::Error(database,
                        std::string("holds several protocols with ") + (pairs ? "choices" : "ratings") +
                            ", which are never pooled",
                        "name with --protocol one of: " + base::joined(names) +
                            "; give --protocol once more for the protocol of the " +
                            (pairs ? "ratings" : "choices"));
  }
}

/// Leaves out the frame rates if they follow from the other attributes: each method of Task 2 has the rate of
/// its scene.
void leave_out_rates_that_follow(std::vector<ScaledTrial>& trials) {
  const auto has_rate = [](const Attributes& side) {
    return !side.empty() && side.back().first == rate_attribute;
  };
  std::map<Attributes, std::set<std::string>> rates;
  for (const ScaledTrial& trial : trials)
    for (const Attributes* side : {&trial.first, &trial.second})
      if (has_rate(*side)) rates[{side->begin(), side->end() - 1}].insert(side->back().second);
  if (std::any_of(rates.begin(), rates.end(), [](const auto& one) { return one.second.size() > 1; })) return;
  for (ScaledTrial& trial : trials)
    for (Attributes* side : {&trial.first, &trial.second})
      if (has_rate(*side)) side->pop_back();
}

std::vector<ScaledTrial> trials_for_scale(const TaskData& data) {
  std::vector<ScaledTrial> out;
  for (const AnsweredTrial& trial : data.answered) {
    for (const TaskAnswer& answer : trial.answers) {
      if (answer.question != data.question.id || !answer.score) continue;
      ScaledTrial one{trial.participant,
                      attributes_of(data.protocol, trial.first, trial.first_nominal, trial.first_cell),
                      {},
                      *answer.score};
      if (data.protocol.pairs) {
        if (!trial.second || !trial.second_cell) continue;
        one.second = attributes_of(data.protocol, *trial.second, trial.second_nominal, *trial.second_cell);
        one.score = *answer.score == data.question.anchors.front().first ? 1 : 2;
      }
      out.push_back(std::move(one));
    }
  }
  leave_out_rates_that_follow(out);
  return out;
}

/// Names each condition by the values of the attributes that differ between conditions. Leaves out the
/// attribute `by`, since each of its values has a scale of its own.
class ConditionNames {
 public:
  ConditionNames(const std::vector<ScaledTrial>& trials, std::string by) : by_(std::move(by)) {
    for (const ScaledTrial& trial : trials)
      for (const Attributes* side : {&trial.first, &trial.second})
        for (const auto& [name, value] : *side) values_[name].insert(value);
    if (by_.empty() || values_.contains(by_)) return;
    std::vector<std::string> names;
    for (const auto& [name, values] : values_) names.push_back(name);
    throw base::Error("--by " + base::shortened(by_), "is nothing that the stimuli of this database have",
                      base::use_one_of(by_, names));
  }

  std::string of(const Attributes& attributes) const {
    std::string out;
    for (const auto& [name, value] : attributes) {
      if (name == by_ || name == scene_attribute || values_.at(name).size() < 2) continue;
      out += (out.empty() ? "" : ", ") + value;
    }
    return out.empty() ? "the only condition" : out;
  }
  std::string part(const Attributes& attributes) const {
    for (const auto& [name, value] : attributes)
      if (name == by_ && !by_.empty()) return value;
    return {};
  }
  bool pools_scenes() const {
    const auto scenes = values_.find(scene_attribute);
    return by_ != scene_attribute && scenes != values_.end() && scenes->second.size() > 1;
  }

 private:
  std::string by_;
  std::map<std::string, std::set<std::string>> values_;
};

}  // namespace

ScaleTable scale_table_of_study(const TaskStudy& study, const ScaleSelection& selection) {
  std::vector<ChosenTask> chosen = chosen_for_scale(study, selection);
  keep_one_question(chosen, selection);
  ScaleTable out{.by = selection.by};
  std::vector<TaskData> all;
  for (const ChosenTask& one : chosen) {
    TaskData data = collect_task(study, one, selection.exclusions);
    if (!data.participants.empty()) all.push_back(std::move(data));
  }
  if (all.empty())
    throw base::Error(selection.database, "holds no choice between the stimuli of a pair and no rating",
                      "run a session of a protocol that shows pairs, or give another database");
  leave_out_unreal(all, out.notes);
  check_one_protocol(all, selection.database);

  std::vector<ScaledTrial> trials;
  std::vector<const TaskData*> parts;
  out.exclusions = Json::array();
  for (const TaskData& data : all) {
    for (ScaledTrial& one : trials_for_scale(data)) trials.push_back(std::move(one));
    for (const auto& one : exclusions_json(data)) out.exclusions.push_back(one);
    parts.push_back(&data);
  }
  out.study = study_json(std::filesystem::path(selection.database).filename().string(), parts, {});
  for (const auto& note : out.study.at("notes")) out.notes.push_back(note.get<std::string>());

  const ConditionNames names(trials, selection.by);
  if (names.pools_scenes())
    out.notes.push_back("the scenes are pooled; --by scene gives each a scale of its own.");
  ScaleCollector collector;
  for (const ScaledTrial& trial : trials) {
    const std::string part = names.part(trial.first), first = names.of(trial.first);
    if (trial.second.empty()) {
      collector.add_rating(part, trial.person, first, trial.score, 1);
      continue;
    }
    const std::string second = names.of(trial.second);
    if (part != names.part(trial.second) || first == second)
      throw base::Error(selection.database,
                        "compares " + base::shortened(first) + " in " + base::shortened(part) + " and " +
                            base::shortened(names.part(trial.second)) + ", which --by " + selection.by +
                            " gives different scales",
                        "leave out --by, or name something that is equal in each pair");
    collector.add_choice(part, trial.person, first, second, trial.score == 1, 1);
  }
  collector.finish(out, selection.database);
  return out;
}

}  // namespace study
