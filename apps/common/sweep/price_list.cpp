#include "apps/common/sweep/price_list.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "apps/common/timing.hpp"
#include "stats/base/error.hpp"

namespace apps {

namespace {

using Group = std::vector<const StoredCell*>;  // one setting's seeds

double centre_distance(const WaterSample& a, const WaterSample& b) {
  return std::hypot(a.centre_m[0] - b.centre_m[0], a.centre_m[1] - b.centre_m[1],
                    a.centre_m[2] - b.centre_m[2]);
}

Spread spread_of(const std::vector<double>& values) {
  Spread out{0, values.front(), values.front()};
  for (const double value : values) {
    out.mean += value / static_cast<double>(values.size());
    out.low = std::min(out.low, value);
    out.high = std::max(out.high, value);
  }
  return out;
}

std::vector<double> frame_ms(const Group& group) {
  std::vector<double> out;
  for (const auto* cell : group)
    for (const auto& frame : cell->run.frames) out.push_back(frame.all_ms());
  return out;
}

double mean(const std::vector<double>& values) {
  double out = 0;
  for (const double value : values) out += value / static_cast<double>(values.size());
  return out;
}

/// For each frame of `from` the difference to the frame of `to` at the same share of the content.
std::vector<double> paired_differences(const Group& from, const Group& to) {
  std::vector<double> out;
  for (std::size_t seed = 0; seed < std::min(from.size(), to.size()); ++seed) {
    const auto &a = from[seed]->run.frames, &b = to[seed]->run.frames;
    for (std::size_t i = 0; i < a.size() && !b.empty(); ++i)
      out.push_back(b[i * b.size() / a.size()].all_ms() - a[i].all_ms());
  }
  return out;
}

struct Sweep {
  const CellRun* reference = nullptr;
  double tank_length_m = 0;
  std::vector<Group> groups = {};

  const Group* find(const SolverSetting& setting) const {
    const auto found = std::find_if(groups.begin(), groups.end(), [&](const Group& group) {
      return to_text(group.front()->cell.setting) == to_text(setting);
    });
    return found == groups.end() ? nullptr : &*found;
  }
  std::vector<SweepErrors> errors(const Group& group) const {
    std::vector<SweepErrors> out;
    for (const auto* cell : group) out.push_back(errors_of(cell->run, *reference, tank_length_m));
    return out;
  }
};

Sweep sweep_of(const std::vector<StoredCell>& cells, const SweepPlan& plan, const SweepOrigin& origin,
               double tank_length_m) {
  Sweep out{.tank_length_m = tank_length_m};
  for (const auto& cell : cells) {
    if (cell.origin != origin || cell.cell.setting.scene != plan.scene || cell.cell.seconds != plan.seconds ||
        cell.cell.size != plan.size)
      continue;
    const bool same =
        !out.groups.empty() && to_text(out.groups.back().front()->cell.setting) == to_text(cell.cell.setting);
    if (same)
      out.groups.back().push_back(&cell);
    else
      out.groups.push_back({&cell});
  }
  const Group* reference = out.find(reference_setting(plan.scene, plan.n_star));
  if (!reference || reference->size() < 2 || reference->front()->cell.seed != 1) {
    throw base::Error("the sweep of " + plan.scene, "has no finished reference with two seeds yet",
                      "let its first two cells run, or give the plan that it was run with");
  }
  out.reference = &reference->front()->run;
  return out;
}

SettingResult result_of(const Sweep& sweep, const Group& group) {
  SettingResult out{.setting = group.front()->cell.setting, .seeds = static_cast<int>(group.size())};
  for (const auto* cell : group) {
    out.particles += cell->run.particles_mean / out.seeds;
    out.substeps += cell->run.substeps_mean / out.seeds;
  }
  const auto ms = frame_ms(group);
  if (!ms.empty()) {
    out.ms_mean = mean(ms);
    out.ms_low_quartile = quantile(ms, 0.25);
    out.ms_median = quantile(ms, 0.5);
    out.ms_high_quartile = quantile(ms, 0.75);
    out.ms_p95 = quantile(ms, 0.95);
  }
  std::vector<double> draws;
  for (const auto* cell : group)
    for (const auto& frame : cell->run.frames)
      draws.push_back(frame.draw_ms.value_or(std::numeric_limits<double>::quiet_NaN()));
  out.draw_ms_mean = mean(draws);
  const auto errors = sweep.errors(group);
  for (std::size_t e = 0; e < sweep_error_count; ++e) {
    std::vector<double> values;
    for (const auto& seed : errors) values.push_back(seed[e]);
    out.errors[e] = spread_of(values);
  }
  return out;
}

/// The one knob in which two settings differ; none when it is none or several.
std::optional<SolverKnob> turned(const SolverSetting& a, const SolverSetting& b) {
  std::optional<SolverKnob> out;
  if (a.method != b.method) return {};
  for (const auto& traits : solver_knobs()) {
    if (a[traits.knob] == b[traits.knob]) continue;
    if (out) return {};
    out = traits.knob;
  }
  return out;
}

Price price_of(const Sweep& sweep, const Group& from, const Group& to, SolverKnob knob) {
  const auto &start = from.front()->cell.setting, &end = to.front()->cell.setting;
  Price out{.method = start.method, .knob = knob, .from = start[knob], .to = end[knob]};
  out.ms = mean(frame_ms(to)) - mean(frame_ms(from));
  if (const auto differences = paired_differences(from, to); !differences.empty()) {
    out.ms_low_quartile = quantile(differences, 0.25);
    out.ms_high_quartile = quantile(differences, 0.75);
  }
  const auto before = sweep.errors(from), after = sweep.errors(to);
  for (std::size_t e = 0; e < sweep_error_count; ++e) {
    std::vector<double> changes;
    for (const auto& a : before)
      for (const auto& b : after) changes.push_back(b[e] - a[e]);
    out.errors[e] = spread_of(changes);
  }
  return out;
}

constexpr std::array<const char*, sweep_error_count> short_errors{"front %", "centre %", "kinetic %",
                                                                  "density %"};

}  // namespace

SweepErrors errors_of(const CellRun& run, const CellRun& reference, double tank_length_m) {
  const auto &a = run.samples, &b = reference.samples;
  if (a.size() != b.size() || a.empty())
    throw base::Error("the sweep", "has cells of different length",
                      "give --seconds as the cells ran with it");
  double front = 0, centre = 0, kinetic = 0, density = 0, most_kinetic = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::abs(a[i].time_s - b[i].time_s) > 1e-9)
      throw base::Error("the sweep", "has cells that were sampled at other instants", "run them anew");
    front += std::pow(a[i].front_m - b[i].front_m, 2);
    centre += std::pow(centre_distance(a[i], b[i]), 2);
    kinetic += std::pow(a[i].kinetic_j_kg - b[i].kinetic_j_kg, 2);
    density += a[i].density_error;
    most_kinetic = std::max(most_kinetic, b[i].kinetic_j_kg);
  }
  const auto count = static_cast<double>(a.size());
  return {100 * std::sqrt(front / count) / tank_length_m, 100 * std::sqrt(centre / count) / tank_length_m,
          most_kinetic > 0 ? 100 * std::sqrt(kinetic / count) / most_kinetic : 0, 100 * density / count};
}

PriceList price_list(const std::vector<StoredCell>& cells, const SweepPlan& plan, const SweepOrigin& origin,
                     double tank_length_m) {
  const Sweep sweep = sweep_of(cells, plan, origin, tank_length_m);
  PriceList out{.origin = origin, .scene = plan.scene};
  const auto reference = reference_setting(plan.scene, plan.n_star);
  const Group& references = *sweep.find(reference);
  out.floor = errors_of(references[1]->run, *sweep.reference, tank_length_m);
  out.floor[static_cast<std::size_t>(SweepError::Density)] = 0;
  const auto finer = finer_references(reference);
  for (const auto& setting : finer)
    if (const Group* group = sweep.find(setting)) out.finer.push_back(result_of(sweep, *group));
  for (const auto& group : sweep.groups) {
    const auto& setting = group.front()->cell.setting;
    if (setting == reference || std::find(finer.begin(), finer.end(), setting) != finer.end()) continue;
    out.settings.push_back(result_of(sweep, group));
  }
  for (const auto method : {sim::MethodKind::HiRes, sim::MethodKind::Ours}) {
    const Group* from = sweep.find(usual_setting(plan.scene, method, plan.n_star));
    if (!from) continue;
    for (const auto& group : sweep.groups) {
      const auto knob = turned(from->front()->cell.setting, group.front()->cell.setting);
      if (knob) out.prices.push_back(price_of(sweep, *from, group, *knob));
    }
  }
  for (std::size_t e = 0; e < sweep_error_count; ++e) {
    double smallest = std::numeric_limits<double>::infinity(), moved = 0;
    for (const auto& setting : out.settings)
      if (setting.errors[e].mean > out.floor[e]) smallest = std::min(smallest, setting.errors[e].mean);
    const double own = errors_of(*sweep.reference, *sweep.reference, tank_length_m)[e];
    for (const auto& one : out.finer) moved = std::max(moved, std::abs(one.errors[e].mean - own));
    out.converged[e] = out.finer.size() == finer.size() && moved < smallest / 3;
  }
  return out;
}

std::string in_words(const Spread& spread) {
  return fmt::format("{:.3g} [{:.3g}, {:.3g}]", spread.mean, spread.low, spread.high);
}

std::vector<std::size_t> pareto_front(const std::vector<SettingResult>& settings, SweepError error) {
  const auto value = [&](std::size_t i) { return settings[i].errors[static_cast<std::size_t>(error)].mean; };
  std::vector<std::size_t> order(settings.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(settings[a].ms_mean, value(a)) < std::pair(settings[b].ms_mean, value(b));
  });
  std::vector<std::size_t> out;
  for (const std::size_t i : order)
    if (out.empty() || value(i) < value(out.back())) out.push_back(i);
  return out;
}

std::vector<SweepCell> more_seeds_of_fronts(const PriceList& list, const SweepPlan& plan, int seeds) {
  std::set<std::size_t> places;
  for (std::size_t e = 0; e < sweep_error_count; ++e)
    for (const std::size_t i : pareto_front(list.settings, static_cast<SweepError>(e))) places.insert(i);
  std::vector<SweepCell> out;
  for (const std::size_t i : places)
    for (int seed = 1; seed <= seeds; ++seed)
      out.push_back({list.settings[i].setting, seed, plan.seconds, plan.size});
  return out;
}

std::string in_words(const SolverSetting& setting) {
  std::string out;
  for (const auto& traits : solver_knobs()) {
    const bool own = traits.knob == SolverKnob::Size || setting[traits.knob] != traits.usual;
    if (own && turns(traits.knob, setting.method))
      out += fmt::format("{}{} {}", out.empty() ? "" : ", ", traits.words,
                         value_words(traits.knob, setting[traits.knob]));
  }
  return out;
}

std::string convergence(const PriceList& list, SweepError error) {
  return list.finer.empty()                                ? "was not held against finer ones"
         : list.converged[static_cast<std::size_t>(error)] ? "counts as converged"
                                                           : "does not count as converged";
}

TextTable setting_table(const PriceList& list) {
  TextTable out{.head = {"scene", "machine", "program", "method", "setting", "seeds", "particles", "substeps",
                         "ms_mean", "ms_q25", "ms_median", "ms_q75", "ms_p95", "draw_ms_mean"},
                .rows = {}};
  for (const char* error : sweep_error_columns) {
    for (const char* end : {"", "_low", "_high"}) out.head.push_back(std::string(error) + end);
  }
  for (const auto* part : {&list.finer, &list.settings}) {
    for (const auto& one : *part) {
      auto& row = out.rows.emplace_back();
      row = {list.scene,
             in_a_cell(list.origin.machine),
             list.origin.program,
             sim::method_name(one.setting.method),
             in_a_cell(in_words(one.setting)),
             std::to_string(one.seeds),
             number(one.particles, 0),
             number(one.substeps, 2),
             number(one.ms_mean, 3),
             number(one.ms_low_quartile, 3),
             number(one.ms_median, 3),
             number(one.ms_high_quartile, 3),
             number(one.ms_p95, 3),
             number(one.draw_ms_mean, 3)};
      for (const auto& error : one.errors)
        for (const double value : {error.mean, error.low, error.high}) row.push_back(number(value, 4));
    }
  }
  return out;
}

TextTable price_table(const PriceList& list) {
  TextTable out{.head = {"scene", "machine", "program", "method", "knob", "from", "to", "ms", "ms_q25",
                         "ms_q75", "free"},
                .rows = {}};
  for (const char* error : sweep_error_columns) {
    for (const char* end : {"", "_low", "_high", "_per_ms"}) out.head.push_back(std::string(error) + end);
  }
  for (const auto& price : list.prices) {
    auto& row = out.rows.emplace_back();
    row = {list.scene,
           in_a_cell(list.origin.machine),
           list.origin.program,
           sim::method_name(price.method),
           traits_of(price.knob).column,
           value_words(price.knob, price.from),
           value_words(price.knob, price.to),
           number(price.ms, 3),
           number(price.ms_low_quartile, 3),
           number(price.ms_high_quartile, 3),
           price.free() ? "yes" : "no"};
    for (const auto& error : price.errors) {
      for (const double value : {error.mean, error.low, error.high}) row.push_back(number(value, 4));
      row.push_back(price.free() ? "-" : number(error.mean / price.ms, 4));
    }
  }
  return out;
}

TextTable settings_to_read(const PriceList& list) {
  TextTable out{.head = {"method", "setting", "particles", "ms mean", "p95"}, .rows = {}};
  for (const char* error : short_errors) out.head.emplace_back(error);
  for (const auto& one : list.settings) {
    auto& row = out.rows.emplace_back();
    row = {sim::method_name(one.setting.method), in_words(one.setting), number(one.particles, 0),
           number(one.ms_mean, 2), number(one.ms_p95, 2)};
    for (const auto& error : one.errors) row.push_back(in_words(error));
  }
  return out;
}

TextTable prices_to_read(const PriceList& list) {
  TextTable out{.head = {"method", "knob", "change", "ms [quartiles]"}, .rows = {}};
  for (const char* error : short_errors) out.head.emplace_back(error);
  for (const auto& price : list.prices) {
    auto& row = out.rows.emplace_back();
    row = {sim::method_name(price.method), traits_of(price.knob).words,
           value_words(price.knob, price.from) + " to " + value_words(price.knob, price.to),
           price.free() ? "free"
                        : fmt::format("{:+.2f} [{:+.2f}, {:+.2f}]", price.ms, price.ms_low_quartile,
                                      price.ms_high_quartile)};
    for (const auto& error : price.errors) row.push_back(in_words(error));
  }
  return out;
}

std::string to_markdown(const PriceList& list) {
  std::string out = fmt::format("{} on {}\n\n{}\n{}\n", list.scene, list.origin.machine,
                                to_markdown(settings_to_read(list)), to_markdown(prices_to_read(list)));
  out += fmt::format("a reference moved by an ulp: front {:.3g} %, centre {:.3g} %, kinetic {:.3g} %\n",
                     list.floor[0], list.floor[1], list.floor[2]);
  for (std::size_t e = 0; e < sweep_error_count; ++e) {
    out += fmt::format("{}: the reference {}\n", sweep_error_columns[e],
                       convergence(list, static_cast<SweepError>(e)));
  }
  return out;
}

}  // namespace apps
