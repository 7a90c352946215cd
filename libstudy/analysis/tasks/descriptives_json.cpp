#include "libstudy/analysis/tasks/descriptives_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "stats/inference/describe.hpp"

namespace study {

namespace {

/// A scale with at most this many scores is listed in full, including scores that were never given.
constexpr int most_listed_scores = 21;

/// One stimulus of a trial: its method (index in the protocol's list), and mean and SD of its nominal frame
/// rate in frames/s. Mean and SD are 0 if all trials have the same frame rate.
struct ShownSetting {
  std::size_t method = 0;
  double mean = 0, sd = 0;
  auto operator<=>(const ShownSetting&) const = default;  // NOLINT(modernize-use-nullptr): false positive
};

/// The key of a line of the table. For a pair it holds both stimuli, sorted by the index of the method in the
/// protocol, then by frame rate. Only a choice between the two stimuli is independent of their order. For any
/// other question each order has a separate line.
struct CellScores {
  std::size_t scene = 0, n_star = 0;
  std::vector<ShownSetting> shown;
  bool by_order = false;  ///< pair: the line covers one order of showing only
  bool turned = false;    ///< with by_order: true for the order that shows shown[1] first
  auto operator<=>(const CellScores&) const = default;  // NOLINT(modernize-use-nullptr): false positive
};

struct Given {
  std::vector<double> scores;
  std::vector<bool> first_stands_first;  ///< for each score of a pair, true if shown[0] was shown first
  std::set<std::string> participants;
};

class Describer {
 public:
  explicit Describer(const TaskData& data) : data_(data) {
    std::set<std::pair<double, double>> settings;
    for (const auto& trial : data.answered)
      settings.insert({trial.first_nominal.mean, trial.first_nominal.sd});
    several_settings_ = settings.size() > 1;
  }

  Json describe(const Question& question) const {
    std::map<CellScores, Given> cells;
    for (const auto& trial : data_.answered) add(trial, question, cells);
    Json list = Json::array();
    for (const auto& [cell, given] : cells) list.push_back(entry(question, cell, given));
    return list;
  }

 private:
  static std::size_t place(const std::vector<std::string>& list, const std::string& item) {
    return static_cast<std::size_t>(std::find(list.begin(), list.end(), item) - list.begin());
  }

  ShownSetting shown(const StimulusSpec& what, const FpsSetting& nominal) const {
    ShownSetting out{place(data_.protocol.methods, treatment_name(what)), 0, 0};
    if (!several_settings_) return out;
    out.mean = nominal.mean;
    out.sd = nominal.sd;
    return out;
  }

  void add(const AnsweredTrial& trial, const Question& question, std::map<CellScores, Given>& cells) const {
    const auto answer = std::find_if(trial.answers.begin(), trial.answers.end(), [&](const auto& one) {
      return one.question == question.id && one.score.has_value();
    });
    if (answer == trial.answers.end()) return;
    CellScores cell{place(data_.protocol.scenes, trial.first.scene),
                    place(data_.protocol.n_stars, trial.first.n_star),
                    {shown(trial.first, trial.first_nominal)}};
    bool in_order = true;
    if (trial.second) {
      cell.shown.push_back(shown(*trial.second, trial.second_nominal));
      in_order = cell.shown[0] <= cell.shown[1];
      if (!in_order) std::swap(cell.shown[0], cell.shown[1]);
      cell.by_order = !is_choice_of_pair(question, cell);
      cell.turned = cell.by_order && !in_order;
    }
    Given& given = cells[cell];
    given.scores.push_back(*answer->score);
    given.first_stands_first.push_back(in_order);
    given.participants.insert(trial.participant);
  }

  std::string name(const ShownSetting& one) const {
    const std::string& method = data_.protocol.methods.at(one.method);
    return several_settings_ ? fmt::format("{}, {:g} frames/s, SD {:g}", method, one.mean, one.sd) : method;
  }

  /// The cell in words: "LoRes" for one stimulus, "LoRes and HiRes" for a pair in both orders, "first HiRes,
  /// then LoRes" for a pair in one order.
  std::string name(const CellScores& cell) const {
    if (cell.shown.size() == 1) return name(cell.shown[0]);
    if (!cell.by_order) return name(cell.shown[0]) + " and " + name(cell.shown[1]);
    return "first " + name(cell.shown[cell.turned ? 1 : 0]) + ", then " +
           name(cell.shown[cell.turned ? 0 : 1]);
  }

  /// True if the question asks the participant to choose one stimulus of a pair.
  bool is_choice_of_pair(const Question& question, const CellScores& cell) const {
    return traits_of(question.kind).labelled && question.anchors.size() == 2 && cell.shown.size() == 2;
  }

  Json distribution(const Question& question, const CellScores& cell, const Given& given) const {
    Json list = Json::array();
    if (is_choice_of_pair(question, cell)) {
      int first = 0;
      for (std::size_t i = 0; i < given.scores.size(); ++i) {
        const bool first_interval = given.scores[i] == question.anchors.front().first;
        first += first_interval == given.first_stands_first[i] ? 1 : 0;
      }
      const int all = static_cast<int>(given.scores.size());
      list.push_back({{"answer", name(cell.shown[0])}, {"count", first}});
      list.push_back({{"answer", name(cell.shown[1])}, {"count", all - first}});
      return list;
    }
    std::map<int, int> counts;
    const bool listed = question.scale_max - question.scale_min < most_listed_scores;
    if (traits_of(question.kind).rated() && listed)
      for (int score = question.scale_min; score <= question.scale_max; ++score) counts[score] = 0;
    std::map<int, std::string> words;
    if (traits_of(question.kind).labelled)
      for (const auto& [score, text] : question.anchors) words[score] = text, counts[score] = 0;
    for (const double score : given.scores) ++counts[static_cast<int>(score)];
    for (const auto& [score, n] : counts)
      list.push_back({{"answer", words.contains(score) ? Json(words[score]) : Json(score)}, {"count", n}});
    return list;
  }

  Json entry(const Question& question, const CellScores& cell, const Given& given) const {
    Json json{{"scene", data_.scenes.at(cell.scene)},
              {"n_star", data_.protocol.n_stars.at(cell.n_star)},
              {"shown", name(cell)},
              {"n", given.scores.size()},
              {"participants", given.participants.size()}};
    // A choice's answers are labels, so they have no mean.
    const auto described = stats::describe(given.scores);
    const bool counted = !traits_of(question.kind).labelled && described;
    json["mean"] = counted ? json_number(described->mean) : Json();
    json["sd"] = counted ? json_number(described->sd) : Json();
    json["median"] = counted ? json_number(described->median) : Json();
    json["distribution"] = distribution(question, cell, given);
    return json;
  }

  const TaskData& data_;
  bool several_settings_ = false;
};

}  // namespace

Json descriptives_json(const TaskData& data, const std::vector<std::string>& questions) {
  const Describer describer(data);
  Json list = Json::array();
  for (const Question& question : data.protocol.questions) {
    if (std::find(questions.begin(), questions.end(), question.id) == questions.end()) continue;
    list.push_back({{"task", task_name(data.task)},
                    {"question", question.id},
                    {"text", question.text},
                    {"cells", describer.describe(question)}});
  }
  return list;
}

}  // namespace study
