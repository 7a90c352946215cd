#include "libstudy/analysis/tasks/cell_values.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

namespace study {

namespace {

using stats::DeclaredHypothesis;
using stats::ExactMean;

const Design& design_of(const TaskData& data) { return data.protocol.whole->design; }

const Cell& cell_of_index(const Design& design, int index) {
  return design.cells.at(static_cast<std::size_t>(index));
}

std::optional<int> score_of(const AnsweredTrial& trial, const std::string& question) {
  for (const TaskAnswer& answer : trial.answers)
    if (answer.question == question) return answer.score;
  return {};
}

/// Sum and count of a participant's answers in a cell.
using Sums = std::map<std::pair<int, int>, std::pair<double, int>>;  // participant, cell

Sums sums_of(std::span<const CellAnswer> answers) {
  Sums out;
  for (const CellAnswer& one : answers) {
    auto& [sum, count] = out[{one.participant, one.cell}];
    sum += one.value;
    ++count;
  }
  return out;
}

/// The mean of the participant's means in the cells. It is an exact fraction of a sum and a count if their
/// common denominator is at most 1,000,000, otherwise a rounded number with count 1. NaN if a cell has no
/// answer.
ExactMean mean_of_cells(const Sums& sums, int participant, const std::vector<int>& cells) {
  constexpr long long largest = 1'000'000;
  long long common = 1;
  double mean = 0;
  for (const int cell : cells) {
    const auto found = sums.find({participant, cell});
    if (found == sums.end()) return {};
    common = common > largest ? common : std::lcm(common, static_cast<long long>(found->second.second));
    mean += found->second.first / found->second.second / static_cast<double>(cells.size());
  }
  const auto count = common * static_cast<long long>(cells.size());
  if (count > largest) return {mean, 1};
  double sum = 0;
  for (const int cell : cells) {
    const auto& [part, n] = sums.at({participant, cell});
    sum += part * static_cast<double>(common / n);
  }
  return {sum, static_cast<int>(count)};
}

/// Cells of a condition. If the outcome is a threshold: the one cell that stands for each track of the
/// condition (DesignTrack::cell).
std::vector<int> condition_cells(const Design& design, const DeclaredHypothesis& hypothesis,
                                 std::size_t which) {
  std::vector<int> cells = cells_with(design, hypothesis.compare.at(which));
  if (!design.procedure || hypothesis.outcome != stats::threshold_outcome) return cells;
  std::set<int> firsts;
  for (const int cell : cells) firsts.insert(first_of_track(design, cell));
  return {firsts.begin(), firsts.end()};
}

std::vector<int> in_group(const std::vector<int>& cells, const std::vector<int>& group) {
  std::vector<int> out;
  for (const int cell : cells)
    if (std::count(group.begin(), group.end(), cell) > 0) out.push_back(cell);
  return out;
}

double constant_of(const DeclaredHypothesis& hypothesis) { return hypothesis.against.value_or(0.5); }

/// Adds indicator variables for the levels of factor f in `cells`, which holds the cell of each row. The
/// level with the lowest index that occurs is the reference and has no indicator.
void add_level_terms(std::vector<stats::Predictor>& terms, const Design& design, std::size_t f,
                     const std::vector<int>& cells) {
  std::vector<double> levels;
  for (const int cell : cells) levels.push_back(cell_of_index(design, cell).levels[f]);
  if (levels.empty()) return;
  const double first = *std::min_element(levels.begin(), levels.end());
  for (auto& term : stats::indicators(design.factors[f].name, levels, first))
    terms.push_back(std::move(term));
}

}  // namespace

std::vector<CellAnswer> cell_answers(const TaskData& data, const Question& question,
                                     std::optional<int> positive) {
  const Design& design = design_of(data);
  const auto share = positive_score(question, positive);
  const bool intervals = design.pairs && traits_of(question.kind).labelled && question.anchors.size() == 2;
  std::vector<CellAnswer> out;
  for (const AnsweredTrial& trial : data.answered) {
    const auto score = score_of(trial, question.id);
    if (!score) continue;
    CellAnswer one{place_in(data.participants, trial.participant), trial.first_cell, {}, 0, *score};
    bool in_order = true;  // true if one.cell was shown in the first interval
    if (trial.second_cell) {
      one.other = trial.second_cell;
      in_order =
          design.standard ? !is_standard(design, cell_of_index(design, one.cell)) : one.cell <= *one.other;
      if (!in_order) std::swap(one.cell, *one.other);
      if (design.standard) one.other.reset();
    }
    if (intervals) {
      one.value = (*score == question.anchors.front().first) == in_order ? 1 : 0;
    } else if (traits_of(question.kind).labelled) {
      one.value = !share ? std::numeric_limits<double>::quiet_NaN() : *score == *share ? 1 : 0;
    } else {
      one.value = *score;
    }
    out.push_back(one);
  }
  return out;
}

std::vector<DesignTrack> tracks_of(const Design& design) {
  std::vector<DesignTrack> out;
  if (!design.procedure) return out;
  for (int i = 0; i < static_cast<int>(design.cells.size()); ++i) {
    const Cell& cell = cell_of_index(design, i);
    if ((design.standard && is_standard(design, cell)) || first_of_track(design, i) != i) continue;
    DesignTrack track{i, ""};
    for (std::size_t f = 0; f < design.factors.size(); ++f)
      if (f != design.procedure->factor)
        track.name +=
            (track.name.empty() ? "" : ", ") + design.factors[f].name + " " + level_name(design, cell, f);
    out.push_back(std::move(track));
  }
  return out;
}

std::vector<PersonTrack> person_tracks(const TaskData& data) {
  const Protocol& protocol = *data.protocol.whole;
  std::vector<PersonTrack> out;
  if (!protocol.design.procedure || protocol.design.procedure->kind == ProcedureKind::Ptpe) return out;
  std::vector<std::vector<TrackAnswer>> answers(data.participants.size());
  for (const AnsweredTrial& trial : data.answered) {
    const auto score = score_of(trial, protocol.design.procedure->question);
    if (score)
      answers.at(static_cast<std::size_t>(place_in(data.participants, trial.participant)))
          .push_back({trial.first_cell, trial.second_cell, *score});
  }
  const auto tracks = tracks_of(protocol.design);
  for (std::size_t person = 0; person < answers.size(); ++person) {
    for (std::size_t t = 0; t < tracks.size(); ++t) {
      TrackEstimate estimate = estimate_track(protocol, tracks[t].cell, answers[person]);
      if (estimate.trials > 0) out.push_back({static_cast<int>(person), t, std::move(estimate)});
    }
  }
  return out;
}

std::vector<int> groups_of_people(const TaskData& data) {
  const auto groups = cell_groups(design_of(data));
  std::vector<int> out(data.participants.size(), -1);
  for (const AnsweredTrial& trial : data.answered) {
    const auto person = static_cast<std::size_t>(place_in(data.participants, trial.participant));
    for (std::size_t g = 0; g < groups.size(); ++g)
      if (std::count(groups[g].begin(), groups[g].end(), trial.first_cell) > 0)
        out.at(person) = static_cast<int>(g);
  }
  return out;
}

std::vector<CellAnswer> threshold_values(const TaskData& data, std::span<const PersonTrack> tracks) {
  const auto all = tracks_of(design_of(data));
  std::vector<CellAnswer> out;
  for (const PersonTrack& one : tracks)
    out.push_back({one.participant, all.at(one.track).cell, {}, one.estimate.threshold.mean, 0});
  return out;
}

ConditionValues condition_values(const TaskData& data, const stats::DeclaredHypothesis& hypothesis,
                                 std::span<const CellAnswer> answers) {
  const Design& design = design_of(data);
  const auto groups = cell_groups(design);
  const auto group_of = groups_of_people(data);
  const Sums sums = sums_of(answers);
  const bool single = hypothesis.compare.size() == 1;
  const bool by_group = compares_groups(design, hypothesis);
  const auto a = condition_cells(design, hypothesis, 0);
  const auto b = single ? std::vector<int>() : condition_cells(design, hypothesis, 1);
  ConditionValues out;
  for (std::size_t person = 0; person < group_of.size(); ++person) {
    if (group_of[person] < 0) continue;
    const auto& group = groups[static_cast<std::size_t>(group_of[person])];
    const auto own_a = in_group(a, group), own_b = in_group(b, group);
    const auto value = [&](const std::vector<int>& cells) {
      return mean_of_cells(sums, static_cast<int>(person), cells);
    };
    if (by_group) {
      if (!own_a.empty()) out.a.push_back(value(own_a));
      if (!own_b.empty()) out.b.push_back(value(own_b));
    } else if (!own_a.empty() && (single || !own_b.empty())) {
      out.a.push_back(value(own_a));
      const double constant = constant_of(hypothesis);
      out.b.push_back(!single ? value(own_b) : constant == 0.5 ? ExactMean{1, 2} : ExactMean{constant, 1});
    }
  }
  return out;
}

stats::AnswerRows condition_rows(const TaskData& data, const stats::DeclaredHypothesis& hypothesis,
                                 std::span<const CellAnswer> answers) {
  const Design& design = design_of(data);
  const auto a = condition_cells(design, hypothesis, 0), b = condition_cells(design, hypothesis, 1);
  stats::AnswerRows out;
  std::vector<int> cells;
  for (const CellAnswer& one : answers) {
    const bool in_a = std::count(a.begin(), a.end(), one.cell) > 0;
    if (!in_a && std::count(b.begin(), b.end(), one.cell) == 0) continue;
    out.answer.push_back(one.value);
    out.participant.push_back(one.participant);
    out.condition.push_back(in_a ? 0 : 1);
    cells.push_back(one.cell);
  }
  for (std::size_t f = 0; f < design.factors.size(); ++f)
    if (!hypothesis.compare.front().contains(design.factors[f].name))
      add_level_terms(out.terms, design, f, cells);
  return out;
}

}  // namespace study
