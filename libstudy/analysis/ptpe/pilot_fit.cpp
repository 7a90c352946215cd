#include "libstudy/analysis/ptpe/pilot_fit.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "libstudy/analysis/ptpe/pilot_people_json.hpp"
#include "stats/base/file.hpp"
#include "stats/base/progress.hpp"
#include "stats/ptpe/solver_interval.hpp"

namespace study {

namespace {

using stats::PilotEstimate;
using stats::PilotMean;

std::string count_words(int n, const std::string& thing) {
  return std::to_string(n) + " " + thing + (n == 1 ? "" : "s");
}

/// Adds a flag with the number of lines (of constant delta) for each of these cases that occurs: the scores
/// never reach the level; they exceed it from the smallest mean frame rate on; they meet it at a setting
/// without crossing it; they cross it more than once. Adds a flag also if they cross the level on fewer than
/// half of the lines. `fitted`: true if a curve was fitted to the contour.
void flag_contour(std::vector<FitFlag>& flags, const stats::Contour& contour, bool fitted) {
  const std::string inner = fitted ? "; the contour's curve goes by the others" : "";
  const auto lines = [&](int n) { return std::to_string(n) + " of " + count_words(contour.lines, "line"); };
  if (contour.above_grid > 0) {
    flags.push_back({"leaves_grid_above", "on " + lines(contour.above_grid) +
                                              " the level is not reached up to the largest mean frame rate" +
                                              inner});
  }
  if (contour.below_grid > 0) {
    flags.push_back({"leaves_grid_below", "on " + lines(contour.below_grid) +
                                              " the level is exceeded from the smallest mean frame rate on" +
                                              inner});
  }
  if (contour.on_node > 0) {
    flags.push_back({"on_node", "on " + lines(contour.on_node) +
                                    " the level is met at a setting and not crossed" +
                                    (fitted ? "; such lines are left out" : "")});
  }
  if (contour.crossed_twice > 0) {
    flags.push_back({"not_monotone", "on " + lines(contour.crossed_twice) +
                                         " the scores cross the level more than once" +
                                         (fitted ? "; every crossing is used" : "")});
  }
  if (2 * contour.crossed < contour.lines) {
    flags.push_back({"short_contour", contour.crossed == 0 ? "on no line do the scores cross the level"
                                                           : "only on " + lines(contour.crossed) +
                                                                 " do the scores cross the level"});
  }
}

/// Adds a flag like "3 answers left out by rule or by hand: straight_lining 2, timing 1".
void flag_exclusions(std::vector<FitFlag>& flags, const TaskData& data) {
  std::map<std::string, int> by_rule;
  int all = 0;
  for (const auto& one : data.exclusions) {
    by_rule[one.rule] += one.answers;
    all += one.answers;
  }
  if (all == 0) return;
  std::string rules;
  for (const auto& [rule, n] : by_rule)
    if (n > 0) rules += (rules.empty() ? "" : ", ") + rule + " " + std::to_string(n);
  flags.push_back(
      {"excluded_answers", count_words(all, "answer") + " left out by rule or by hand: " + rules});
}

void flag_data(std::vector<FitFlag>& flags, const TaskData& data, const stats::PilotTable& table) {
  if (data.test_data) flags.push_back({"test_data", "these are test data, not a study"});
  if (!data.simulated.empty()) {
    flags.push_back(
        {"simulated", count_words(static_cast<int>(data.simulated.size()), "participant") + " simulated"});
  }
  if (!data.imported.empty()) flags.push_back({"imported", "imported: " + data.imported_words()});
  if (data.asked_rates > 0)
    flags.push_back({"timing_not_recorded",
                     count_words(data.asked_rates, "rating") +
                         " without recorded timing enter at the mean and standard deviation that were asked "
                         "for, under the harmonic and the arithmetic mean alike"});
  if (data.stated_rates > 0)
    flags.push_back({"timing_stated", count_words(data.stated_rates, "rating") +
                                          " without recorded frames enter at the frame rates that the source "
                                          "states"});
  for (const auto& protocol : data.set_aside)
    flags.push_back(
        {"protocol_left_out", "protocol " + protocol.name + ", left out: it holds no real answers"});
  if (data.flow.test_left_out > 0) {
    flags.push_back(
        {"test_data_left_out", count_words(data.flow.test_left_out, "session") + " of test data left out"});
  }
  if (data.flow.simulated_left_out > 0) {
    flags.push_back({"simulated_left_out", count_words(data.flow.simulated_left_out, "session") +
                                               " of simulated observers left out"});
  }
  if (table.incomplete_participants() > 0) {
    flags.push_back(
        {"incomplete_participants", count_words(table.incomplete_participants(), "participant") +
                                        " lack settings that others rated; means use what is there"});
  }
  flag_exclusions(flags, data);
  const auto degraded = std::count_if(data.showings.begin(), data.showings.end(), [](const auto& one) {
    return one.analysed && one.shown.verdict == Verdict::Degraded;
  });
  if (degraded > 0) {
    flags.push_back({"degraded_trials", count_words(static_cast<int>(degraded), "trial") +
                                            " with degraded timing enter at what was really shown"});
  }
}

void flag_resamples(std::vector<FitFlag>& flags, const PilotEstimate& contour) {
  if (!contour.spread) return;
  if (contour.spread->failed > 0) {
    flags.push_back({"resamples_without_fit",
                     count_words(contour.spread->failed, "resample") + " without a contour left out"});
  }
  if (contour.spread->extremes) {
    flags.push_back(
        {"few_participants", "the contour's intervals end at the outermost resamples and are too narrow"});
  }
}

void flag_direct(std::vector<FitFlag>& flags, const stats::DirectEstimate& direct) {
  if (!direct.out_of_reach.empty()) {
    flags.push_back(
        {"out_of_reach", fmt::format("at standard deviations of {:g} the curve lies outside the frame "
                                     "rates shown; those settings are left out and the curve is "
                                     "extrapolated there",
                                     fmt::join(direct.out_of_reach, ", "))});
  }
}

void flag_form(std::vector<FitFlag>& flags, const stats::DirectEstimate& direct) {
  if (direct.fit && !direct.form)
    flags.push_back({"form_not_tested",
                     "whether the curve is an exponential could not be tested: " + direct.form.reason()});
}

void flag_main(std::vector<FitFlag>& flags, const MainEstimate& main, const PilotEstimate& contour) {
  if (!main.spread) return;
  if (!main.spread->spans_contour) {
    flags.push_back({"contour_without_interval",
                     "the contour has no interval (" + contour.spread.reason() +
                         "): those for the solver are the direct estimate's alone, which may be too narrow"});
  }
  if (main.spread->b_ci[0] <= 0 && main.spread->b_ci[1] >= 0) {
    flags.push_back({"b_holds_zero", "the interval of b holds 0: no effect of the fluctuation is shown"});
  }
}

/// The reason why the fit cannot be used, for example a or b outside the range that a solver accepts; empty
/// if it can be used.
std::string unusable(const PilotFit& fit, const TaskData& data, const stats::PilotTable& table) {
  if (table.ratings() == 0) return "no answered trial is left to analyse";
  if (!within_scale(fit.level, data.question)) return outside_scale(fit.level, data.question);
  if (table.all_equal()) return "all ratings are equal: there is no contour";
  const auto main = fit.main();
  if (!main.fit) return main.fit.reason();
  if (!main.spread) return main.spread.reason();
  if (!(main.fit->a >= 1e-3 && main.fit->a <= 1e4 && std::abs(main.fit->b) <= 1)) {
    return "a solver cannot use the curve: it needs a from 0.001 to 10000 frames/s and b from -1 to 1 "
           "s/frame, and the fit has a = " +
           std::to_string(main.fit->a) + ", b = " + std::to_string(main.fit->b);
  }
  return "";
}

/// True if the scale is the paper's, 1 to 7. The pilot is then also fitted at the paper's levels 4 and 5.
bool on_papers_scale(const Question& question) { return question.scale_min == 1 && question.scale_max == 7; }

/// The ratings as categories for the ordinal model. Reverse coders are left out if the plan excludes them.
/// Scores are not corrected for drift or lapses, since a corrected score is no category.
struct Categories {
  std::vector<stats::PilotRating> ratings;
  double lapse_rate = 0, lowest = 1;
  stats::ScaleEnds ends;

  /// Expected mean score of all answers, lapses included, if the mean of the answers without lapses is
  /// `level`.
  double with_lapses(double level) const { return (1 - lapse_rate) * level + lapse_rate * lowest; }
};

Categories categories_of(const TaskData& data, const stats::PilotPeople& people,
                         const stats::PilotRules& rules) {
  Categories out;
  auto kept = rules;
  kept.model_drift = kept.model_lapses = false;
  out.ratings = stats::apply_rules(data.ratings, people, kept);
  out.ends = {static_cast<double>(data.question.scale_min), static_cast<double>(data.question.scale_max)};
  if (rules.model_lapses && people.lapses) {
    out.lapse_rate = people.lapses->rate;
    out.lowest = people.lapses->lowest;
  }
  return out;
}

/// `drawn`: two resampled curves, of the direct and the contour estimate; none: they are computed here.
LevelFit fit_level(const Categories& categories, const stats::PilotTable& table, PilotMean mean, double level,
                   const stats::BootstrapOptions& options, const stats::ResampledCurves* drawn) {
  LevelFit fit;
  fit.direct = stats::estimate_direct(table.observations(mean), level, options, drawn);
  fit.contour = stats::estimate_pilot(table, mean, level, options, drawn ? drawn + 1 : nullptr);
  if (mean == PilotMean::Arithmetic) return fit;
  fit.ordinal = stats::estimate_ordinal_pilot(categories.ratings, mean, categories.with_lapses(level),
                                              options.confidence);
  fit.band = stats::scale_end_curve(table.observations(mean), fit.direct, level, categories.ends);
  return fit;
}

std::set<double> fitted_levels(const TaskData& data, double level) {
  std::set<double> levels{level};
  if (on_papers_scale(data.question)) levels.insert({4.0, 5.0});
  return levels;
}

/// Shows how many resamples are done.
class Resampling {
 public:
  Resampling(std::size_t levels, int resamples, const stats::BootstrapOptions& bootstrap)
      : progress_("resampling participants", 4 * levels * static_cast<std::size_t>(resamples)),
        options_(bootstrap) {
    options_.progress = [this](int) { progress_.update(++done_); };
  }
  Resampling(const Resampling&) = delete;
  Resampling& operator=(const Resampling&) = delete;
  const stats::BootstrapOptions& options() const { return options_; }

 private:
  base::Progress progress_;
  std::size_t done_ = 0;
  stats::BootstrapOptions options_;
};

}  // namespace

bool PilotFit::level_within_scale() const { return within_scale(level, data.question); }

MainEstimate PilotFit::main() const {
  const auto& direct = chosen().direct;
  if (!direct.fit) return {stats::Refusal{direct.fit.reason()}, stats::Refusal{direct.fit.reason()}};
  const MainFit fit{direct.fit->curve.a(), direct.fit->curve.b};
  if (!direct.jackknife) return {fit, stats::Refusal{direct.jackknife.reason()}};
  const auto& spread = *direct.jackknife;
  const auto open = stats::solver_interval(spread, chosen().contour.spread);
  return {fit, MainSpread{open.a_ci, open.b_ci, spread.a_se(), spread.b_se(), open.spans_contour}};
}

double PilotFit::relative_half_width() const {
  const auto& direct = chosen().direct;
  return direct.jackknife->largest_relative_half_width(direct.in_reach_of(deltas));
}

FitResamples resample_fit(const TaskData& data, double level, const stats::BootstrapOptions& bootstrap,
                          const stats::PilotRules& rules, stats::ResampleRange range) {
  const auto people = stats::pilot_people(data.ratings, bootstrap.confidence);
  const stats::PilotTable table(stats::apply_rules(data.ratings, people, rules));
  const auto levels = fitted_levels(data, level);
  const Resampling resampling(levels.size(), range.count, bootstrap);
  FitResamples out;
  for (const double at : levels) {
    for (const auto mean : {PilotMean::Harmonic, PilotMean::Arithmetic}) {
      out.push_back(stats::resample_direct(table.observations(mean), at, resampling.options(), range));
      out.push_back(stats::resample_pilot(table, mean, at, resampling.options(), range));
    }
  }
  return out;
}

PilotFit fit_pilot(TaskData data, double level, const stats::BootstrapOptions& bootstrap,
                   const stats::PilotRules& rules, const FitResamples* drawn) {
  PilotFit fit;
  fit.rules = rules;
  fit.people = stats::pilot_people(data.ratings, bootstrap.confidence);
  const auto categories = categories_of(data, fit.people, rules);
  data.ratings = stats::apply_rules(data.ratings, fit.people, rules);
  const stats::PilotTable table(data.ratings);
  fit.level = level;
  fit.bootstrap = bootstrap;
  fit.participants = table.participants();
  fit.settings = table.settings();
  fit.grid = table.grid(PilotMean::Harmonic);
  for (std::size_t cell = 0; cell < fit.grid.nodes.size(); ++cell) fit.scores.push_back(table.scores(cell));
  fit.deltas = fit.grid.delta;
  const auto levels = fitted_levels(data, level);
  const Resampling resampling(levels.size(), bootstrap.resamples, bootstrap);
  if (drawn && drawn->size() != 4 * levels.size())
    throw std::invalid_argument("fit_pilot: give the resamples of resample_fit() with the same arguments");
  const auto* next = drawn ? drawn->data() : nullptr;
  const auto fitted = [&](PilotMean mean, double at) {
    const auto* curves = next;
    if (next) next += 2;
    return fit_level(categories, table, mean, at, resampling.options(), curves);
  };
  for (const double at : levels) {
    fit.harmonic[at] = fitted(PilotMean::Harmonic, at);
    fit.arithmetic[at] = fitted(PilotMean::Arithmetic, at);
  }
  fit.reason = unusable(fit, data, table);
  if (!fit.ok()) {
    // A contour of another form can be why there is no fit.
    const auto form = stats::form_doubt(fit.chosen().direct);
    if (form && !fit.chosen().direct.jackknife) fit.reason += "; " + form->text;
  } else {
    const LevelFit& chosen = fit.chosen();
    fit.doubts = stats::pilot_doubts(table, chosen.direct, chosen.contour, chosen.ordinal);
    if (auto form = stats::form_doubt(chosen.direct)) fit.doubts.push_back(std::move(*form));
    if (auto band = stats::band_doubt(chosen.direct.fit->curve, chosen.band, fit.deltas))
      fit.doubts.push_back(std::move(*band));
  }
  for (const auto& doubt : fit.doubts) fit.flags.push_back({doubt.code, "not for a solver: " + doubt.text});
  flag_data(fit.flags, data, table);
  flag_direct(fit.flags, fit.chosen().direct);
  flag_form(fit.flags, fit.chosen().direct);
  flag_main(fit.flags, fit.main(), fit.chosen().contour);
  flag_contour(fit.flags, fit.chosen().contour.contour, static_cast<bool>(fit.chosen().contour.fit));
  flag_resamples(fit.flags, fit.chosen().contour);
  fit.data = std::move(data);
  const auto raters = rater_flags(fit);
  fit.flags.insert(fit.flags.end(), raters.begin(), raters.end());
  return fit;
}

sim::PtpeFile ptpe_file(const PilotFit& fit) {
  sim::PtpeFile file;
  const auto main = fit.main();
  file.model = {main.fit->a, main.fit->b};
  file.level = fit.level;
  file.a_ci = main.spread->a_ci;
  file.b_ci = main.spread->b_ci;
  file.n_participants = fit.participants;
  file.n_simulated = static_cast<int>(fit.data.simulated.size());
  file.test_data = fit.data.test_data;
  file.protocol_sha256 = fit.data.protocol.sha256;
  file.date_utc = base::utc_now();
  const LevelFit& chosen = fit.chosen();
  if (stats::band_doubt(chosen.direct.fit->curve, chosen.band, fit.deltas)) return file;
  for (const double delta : fit.deltas) {
    const auto& away = chosen.direct.out_of_reach;
    file.band.push_back({delta, chosen.band->band(delta).pointwise,
                         std::find(away.begin(), away.end(), delta) == away.end()});
  }
  return file;
}

}  // namespace study
