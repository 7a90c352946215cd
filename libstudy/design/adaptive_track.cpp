#include "libstudy/design/adaptive_track.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "stats/ptpe/placement.hpp"

namespace study {

namespace {

constexpr int threshold_points = 41;
constexpr int shape_points = 6;

const Cell& cell_at(const Design& design, int index) { return design.cells[static_cast<std::size_t>(index)]; }

/// True if the cells differ at most in the level of the adaptive factor.
bool same_track(const Design& design, const Cell& a, const Cell& b) {
  for (std::size_t f = 0; f < design.factors.size(); ++f)
    if (f != design.procedure->factor && a.levels[f] != b.levels[f]) return false;
  return true;
}

/// Cells of the track of `cell` as indices into Design::cells, by ascending level of the adaptive factor.
/// Leaves out the cell of the standard, the stimulus with which the pairs compare the others.
std::vector<int> track_cells(const Design& design, const Cell& cell) {
  std::vector<int> out;
  for (int i = 0; i < static_cast<int>(design.cells.size()); ++i) {
    const Cell& other = cell_at(design, i);
    if (same_track(design, cell, other) && !(design.standard && is_standard(design, other))) out.push_back(i);
  }
  std::ranges::sort(out, {}, [&](int i) { return cell_at(design, i).levels[design.procedure->factor]; });
  return out;
}

/// The cell that a trial compares with the standard; `first` if the trial shows a single stimulus.
int comparison_of(const Design& design, int first, std::optional<int> second) {
  return second && is_standard(design, cell_at(design, first)) ? *second : first;
}

bool is_positive(const Protocol& protocol, const TrackAnswer& answer) {
  const Procedure& procedure = *protocol.design.procedure;
  if (!answer.second) return answer.score == procedure.positive;
  // The lower score of a two-interval question names the first interval.
  int lowest = answer.score;
  for (const auto& [block, question] : all_questions(protocol))
    if (question->id == procedure.question) lowest = scores_of(*question).front();
  const bool chose_first = answer.score == lowest;
  const bool first_is_standard = is_standard(protocol.design, cell_at(protocol.design, answer.first));
  return (chose_first != first_is_standard) == procedure.comparison;
}

/// One answer in a track (a run of the adaptive procedure). place: index of the answered cell among the
/// track's cells, which ascend by level of the adaptive factor (track_cells()).
struct TrackStep {
  int place = 0;
  bool positive = false;
  int score = 0;
};

std::vector<TrackStep> steps_of(const Protocol& protocol, const std::vector<int>& cells,
                                std::span<const TrackAnswer> answers) {
  std::vector<TrackStep> out;
  for (const TrackAnswer& answer : answers) {
    const int cell = comparison_of(protocol.design, answer.first, answer.second);
    const auto found = std::ranges::find(cells, cell);
    if (found != cells.end())
      out.push_back({static_cast<int>(found - cells.begin()), is_positive(protocol, answer), answer.score});
  }
  return out;
}

std::vector<double> values_of(const Design& design, const std::vector<int>& cells) {
  std::vector<double> out;
  for (const int cell : cells)
    out.push_back(
        design.procedure
            ->values[static_cast<std::size_t>(cell_at(design, cell).levels[design.procedure->factor])]);
  return out;
}

/// Grid of psychometric functions: each combination of 41 thresholds over the range of `values`, 6 shapes and
/// the procedure's lapse rates. The shape runs from shallow to steep: for a Weibull function the exponent
/// from 1 to 12, else the spread from 1/2 to 1/50 of the range.
std::vector<stats::PsychometricCurve> curves_of(const Procedure& procedure,
                                                const std::vector<double>& values) {
  const double low = values.front(), high = values.back(), width = high - low;
  const bool weibull = procedure.form == stats::PsychometricForm::Weibull;
  std::vector<stats::PsychometricCurve> out;
  for (int t = 0; t < threshold_points; ++t) {
    const double share = static_cast<double>(t) / (threshold_points - 1);
    const double threshold = weibull ? low * std::pow(high / low, share) : low + share * width;
    for (int s = 0; s < shape_points; ++s) {
      const double step = static_cast<double>(s) / (shape_points - 1);
      const double shape = weibull ? std::pow(12.0, step) : width / 2 * std::pow(1.0 / 25, step);
      for (const double lapse : procedure.lapses)
        out.push_back({procedure.form, threshold, shape, procedure.guess, lapse});
    }
  }
  return out;
}

stats::QuestPlus quest_of(const std::vector<stats::PsychometricCurve>& curves,
                          const std::vector<double>& values) {
  const std::vector<double> even(curves.size(), 1.0);
  return {static_cast<int>(values.size()), 2, even, [&](int s, int p, int o) {
            const double yes = curves[static_cast<std::size_t>(p)](values[static_cast<std::size_t>(s)]);
            return o == 0 ? yes : 1 - yes;
          }};
}

/// Returns `fixed` indices, evenly spread over 0 ... count - 1 and ascending. If `fixed` exceeds `count`, the
/// sequence starts over after `count` indices. A single index is count / 2.
std::vector<int> spread_evenly(int fixed, int count) {
  std::vector<int> out;
  const int round = std::min(fixed, count);
  for (int i = 0; i < fixed; ++i)
    out.push_back(round == 1 ? count / 2 : i % round * (count - 1) / (round - 1));
  return out;
}

int next_by_staircase(const Procedure& procedure, const std::vector<TrackStep>& steps, int count) {
  const auto positive = std::make_unique<bool[]>(steps.size() + 1);
  for (std::size_t i = 0; i < steps.size(); ++i) positive[i] = steps[i].positive;
  stats::StaircaseRules rules = procedure.rules;
  rules.trials = 0;  // 0: the track never ends, because the plan sets the number of trials
  const double next = stats::replay_staircase(rules, {positive.get(), steps.size()}).stimuli.back();
  return std::clamp(static_cast<int>(std::lround(next)), 0, count - 1);
}

int next_by_quest(const Procedure& procedure, const std::vector<double>& values,
                  const std::vector<TrackStep>& steps) {
  const auto curves = curves_of(procedure, values);
  stats::QuestPlus quest = quest_of(curves, values);
  std::vector<int> times(values.size()), allowed;
  for (const TrackStep& step : steps) {
    quest.update(step.place, step.positive ? 0 : 1);
    ++times[static_cast<std::size_t>(step.place)];
  }
  for (std::size_t i = 0; i < times.size(); ++i)
    if (times[i] < procedure.most_of_one) allowed.push_back(static_cast<int>(i));
  return quest.next(allowed);
}

int next_by_placement(const Protocol& protocol, const std::vector<int>& cells,
                      const std::vector<TrackStep>& steps, const std::vector<TrackStep>& earlier,
                      int person) {
  const Procedure& procedure = *protocol.design.procedure;
  std::vector<stats::PlacementSetting> settings;
  for (const int cell : cells) {
    const auto level = static_cast<std::size_t>(cell_at(protocol.design, cell).levels[procedure.factor]);
    settings.push_back({procedure.values[level], procedure.deviation[level]});
  }
  stats::PlacementPrior prior = stats::placement_prior(settings);
  for (const auto& [block, question] : all_questions(protocol)) {
    if (question->id != procedure.question) continue;
    prior.lowest = question->scale_min;
    prior.highest = question->scale_max;
    prior.level = fitted_level(*question);
  }
  stats::PlacementRules rules;
  rules.trials = procedure.trials;
  rules.between = procedure.fixed;
  rules.most_of_one = procedure.most_of_one;
  stats::Placement placement(settings, prior, rules);
  placement.set_person(person);
  for (const TrackStep& step : earlier) placement.learn(step.place, step.score);
  for (const TrackStep& step : steps) placement.add(step.place, step.score);
  return placement.next();
}

}  // namespace

int first_of_track(const Design& design, int cell) {
  const auto cells = track_cells(design, cell_at(design, cell));
  return cells.empty() ? cell : cells.front();
}

std::vector<PlannedTrial> track_trials(const Design& design, const std::vector<int>& group,
                                       RandomStream& random) {
  std::vector<PlannedTrial> out;
  for (const int cell : group) {
    if ((design.standard && is_standard(design, cell_at(design, cell))) ||
        first_of_track(design, cell) != cell)
      continue;
    PlannedTrial trial;
    trial.first = cell;
    for (const auto& [comparison, standard] :
         design.pairs ? pairs_of_group(design, group) : std::vector<std::pair<int, int>>())
      if (comparison == cell) trial.second = standard;
    for (int i = 0; i < design.procedure->trials; ++i) {
      out.push_back(trial);
      if (trial.second && i % 2 == 1) std::swap(out.back().first, *out.back().second);
    }
  }
  shuffle(out, random);
  return out;
}

PlannedTrial chosen_trial(const Protocol& protocol, const PlannedTrial& planned,
                          const TrackAnswers& answers) {
  const Design& design = protocol.design;
  const int placeholder = comparison_of(design, planned.first, planned.second);
  const auto cells = track_cells(design, cell_at(design, placeholder));
  const auto steps = steps_of(protocol, cells, answers.own);
  const Procedure& procedure = *design.procedure;
  const auto count = static_cast<int>(cells.size());
  int place = 0;
  if (procedure.kind == ProcedureKind::Staircase)
    place = next_by_staircase(procedure, steps, count);
  else if (procedure.kind == ProcedureKind::Ptpe)
    place =
        next_by_placement(protocol, cells, steps, steps_of(protocol, cells, answers.earlier), answers.person);
  else if (static_cast<int>(steps.size()) < procedure.fixed)
    place = spread_evenly(procedure.fixed, count)[steps.size()];
  else
    place = next_by_quest(procedure, values_of(design, cells), steps);
  PlannedTrial out = planned;
  (out.first == placeholder ? out.first : *out.second) = cells[static_cast<std::size_t>(place)];
  return out;
}

TrackEstimate estimate_track(const Protocol& protocol, int cell, std::span<const TrackAnswer> answers) {
  const Design& design = protocol.design;
  const auto cells = track_cells(design, cell_at(design, cell));
  const auto values = values_of(design, cells);
  const auto curves = curves_of(*design.procedure, values);
  stats::QuestPlus quest = quest_of(curves, values);
  TrackEstimate out;
  out.values = values;
  out.trials_at.resize(values.size());
  out.positive_at.resize(values.size());
  for (const TrackStep& step : steps_of(protocol, cells, answers)) {
    quest.update(step.place, step.positive ? 0 : 1);
    ++out.trials;
    ++out.trials_at[static_cast<std::size_t>(step.place)];
    out.positive_at[static_cast<std::size_t>(step.place)] += step.positive ? 1 : 0;
  }
  std::vector<double> thresholds, shapes;
  for (const stats::PsychometricCurve& curve : curves) {
    thresholds.push_back(curve.threshold);
    shapes.push_back(curve.shape);
  }
  out.threshold = stats::grid_estimate(thresholds, quest.posterior());
  out.shape = stats::grid_estimate(shapes, quest.posterior());
  return out;
}

}  // namespace study
