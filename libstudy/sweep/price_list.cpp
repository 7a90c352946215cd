#include "libstudy/sweep/price_list.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "stats/base/error.hpp"
#include "stats/base/timing.hpp"
#include "stats/ptpe/ptpe.hpp"

namespace study {

namespace {

using Group = std::vector<const StoredCell*>;  // cells of one setting with different seeds

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

double tau_of(const Group& group) {
  std::vector<double> intervals_s;
  const double period_ms = 1000 / group.front()->cell.setting[sim::SolverKnob::Rate];
  for (const double ms : frame_ms(group)) intervals_s.push_back(std::max(ms, period_ms) / 1000);
  return intervals_s.empty() ? std::numeric_limits<double>::quiet_NaN()
                             : stats::ptpe_tolerance({}, stats::fps_moments(intervals_s));
}

/// Time of a frame of `to` minus time of the frame of `from` at the same fraction of the run, in ms, for each
/// frame of `from`.
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
  std::map<const CellRun*, SweepErrors> errors_of = {};
  double parting_s = 0;

  const Group* find(const sim::SolverSetting& setting) const {
    const auto found = std::find_if(groups.begin(), groups.end(), [&](const Group& group) {
      return sim::to_text(group.front()->cell.setting) == sim::to_text(setting);
    });
    return found == groups.end() ? nullptr : &*found;
  }
  std::vector<SweepErrors> errors(const Group& group) const {
    std::vector<SweepErrors> out;
    for (const auto* cell : group) out.push_back(errors_of.at(&cell->run));
    return out;
  }
};

/// Text for an error: machine, program and options of the request, then the number of cells of the scene for
/// each other machine, program and options: " of MACHINE, program P, ...; it holds 24 cells of ...". Empty if
/// there are no other cells.
std::string others_in_words(const std::vector<StoredCell>& cells, const SweepPlan& plan,
                            const SweepOrigin& origin) {
  const auto named = [](const SweepOrigin& from, double seconds, const std::string& size,
                        const std::string& kept) {
    return fmt::format("{}, program {}, {:.4g} s, timed pictures {}, compared {}", from.machine, from.program,
                       seconds, size.empty() ? "none" : size, kept.empty() ? "none" : kept);
  };
  std::map<std::string, int> others;
  for (const auto& cell : cells)
    if (cell.cell.setting.scene == plan.scene)
      ++others[named(cell.origin, cell.cell.seconds, cell.cell.size, cell.cell.kept)];
  const std::string own = named(origin, plan.seconds, plan.size, plan.kept);
  std::string out;
  for (const auto& [words, count] : others)
    if (words != own)
      out += fmt::format("{}{} cells of {}", out.empty() ? "; it holds " : " and ", count, words);
  return out.empty() ? out : " of " + own + out;
}

/// Computes the errors of all runs and stores them in errors_of. `twin`: the reference from a perturbed
/// start.
void measure(Sweep& sweep, const CellRun& twin) {
  std::vector<const CellRun*> runs;
  for (const auto& group : sweep.groups)
    for (const auto* cell : group) runs.push_back(&cell->run);
  const auto pictures = score_pictures(runs, *sweep.reference, twin);
  sweep.parting_s = pictures.parting_s;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    auto& errors = sweep.errors_of[runs[i]];
    const auto water = water_errors(*runs[i], *sweep.reference, sweep.tank_length_m);
    std::copy(water.begin(), water.end(), errors.begin());
    std::copy(pictures.errors[i].begin(), pictures.errors[i].end(), errors.begin() + water_error_count);
  }
}

Sweep sweep_of(const std::vector<StoredCell>& cells, const SweepPlan& plan, const SweepOrigin& origin,
               double tank_length_m) {
  Sweep out{.tank_length_m = tank_length_m};
  for (const auto& cell : cells) {
    if (cell.origin != origin || cell.cell.setting.scene != plan.scene || cell.cell.seconds != plan.seconds ||
        cell.cell.size != plan.size || cell.cell.kept != plan.kept)
      continue;
    const bool same = !out.groups.empty() && sim::to_text(out.groups.back().front()->cell.setting) ==
                                                 sim::to_text(cell.cell.setting);
    if (same)
      out.groups.back().push_back(&cell);
    else
      out.groups.push_back({&cell});
  }
  const Group* reference = out.find(reference_setting(plan.scene, plan.n_star));
  if (!reference || reference->size() < 2 || reference->front()->cell.seed != 1) {
    throw base::Error("the sweep of " + plan.scene,
                      "has no finished reference with two seeds yet" + others_in_words(cells, plan, origin),
                      "run its first two cells, or give the options with which the sweep was run");
  }
  out.reference = &reference->front()->run;
  measure(out, (*reference)[1]->run);
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
    out.ms_low_quartile = base::quantile(ms, 0.25);
    out.ms_median = base::quantile(ms, 0.5);
    out.ms_high_quartile = base::quantile(ms, 0.75);
    out.ms_p95 = base::quantile(ms, 0.95);
  }
  std::vector<double> draws;
  for (const auto* cell : group)
    for (const auto& frame : cell->run.frames)
      draws.push_back(frame.draw_ms.value_or(std::numeric_limits<double>::quiet_NaN()));
  out.draw_ms_mean = mean(draws);
  out.tau = tau_of(group);
  const auto errors = sweep.errors(group);
  for (std::size_t e = 0; e < sweep_error_count; ++e) {
    std::vector<double> values;
    for (const auto& seed : errors) values.push_back(seed[e]);
    out.errors[e] = spread_of(values);
  }
  return out;
}

/// The knob in which two settings of one method differ; empty unless they differ in exactly one knob.
std::optional<sim::SolverKnob> turned(const sim::SolverSetting& a, const sim::SolverSetting& b) {
  std::optional<sim::SolverKnob> out;
  if (a.method != b.method) return {};
  for (const auto& traits : sim::solver_knobs()) {
    if (a[traits.knob] == b[traits.knob]) continue;
    if (out) return {};
    out = traits.knob;
  }
  return out;
}

Price price_of(const Sweep& sweep, const Group& from, const Group& to, sim::SolverKnob knob) {
  const auto &start = from.front()->cell.setting, &end = to.front()->cell.setting;
  Price out{.method = start.method, .knob = knob, .from = start[knob], .to = end[knob]};
  out.ms = mean(frame_ms(to)) - mean(frame_ms(from));
  if (const auto differences = paired_differences(from, to); !differences.empty()) {
    out.ms_low_quartile = base::quantile(differences, 0.25);
    out.ms_high_quartile = base::quantile(differences, 0.75);
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

double most_kinetic(const CellRun& run) {
  double out = 0;
  for (const auto& sample : run.samples) out = std::max(out, sample.kinetic_j_kg);
  return out;
}

/// Order of convergence of `runs`, which are sorted from coarse to fine. `steps`: each run's particle spacing
/// or time step, divided by that of the first run.
ObservedOrder order_of(const std::string& of, const std::vector<const CellRun*>& runs,
                       const std::vector<double>& steps, double tank_length_m) {
  ObservedOrder out{of, steps, {}};
  for (std::size_t e = 0; e < out.order.size(); ++e) {
    double count = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t i = 0; i + 1 < runs.size(); ++i) {
      const double log_step = std::log(steps[i]);
      double distance = water_errors(*runs[i], *runs[i + 1], tank_length_m)[e];
      // The kinetic error is a share of the finer run's maximum, which differs between runs. The product is
      // an absolute error.
      if (e == static_cast<std::size_t>(SweepError::Kinetic)) distance *= most_kinetic(*runs[i + 1]);
      const double log_distance = std::log(distance);
      count += 1;
      x += log_step;
      y += log_distance;
      xx += log_step * log_step;
      xy += log_step * log_distance;
    }
    const double slope = (count * xy - x * y) / (count * xx - x * x);
    out.order[e] = std::isfinite(slope) ? slope : std::numeric_limits<double>::quiet_NaN();
  }
  return out;
}

/// Runs with seed 1 of HiRes' usual setting, with the knob at each of these values. Empty if one of these
/// runs is missing.
std::vector<const CellRun*> refined(const Sweep& sweep, const SweepPlan& plan, sim::SolverKnob knob,
                                    const std::vector<double>& values) {
  std::vector<const CellRun*> out;
  for (const double value : values) {
    auto setting = sim::usual_setting(plan.scene, sim::MethodKind::HiRes, plan.n_star);
    setting[knob] = value;
    const Group* group = sweep.find(setting);
    if (!group || group->front()->cell.seed != 1) return {};
    out.push_back(&group->front()->run);
  }
  return out;
}

std::vector<ObservedOrder> observed_orders(const Sweep& sweep, const SweepPlan& plan) {
  std::vector<double> sizes, spacings;
  for (const double share : {0.25, 0.5, 1.0, 2.0}) {
    sizes.push_back(std::round(share * static_cast<double>(plan.n_star)));
    spacings.push_back(std::cbrt(sizes.front() / sizes.back()));
  }
  std::vector<ObservedOrder> out;
  if (const auto runs = refined(sweep, plan, sim::SolverKnob::Size, sizes); !runs.empty())
    out.push_back(order_of("particle spacing", runs, spacings, sweep.tank_length_m));
  if (const auto runs = refined(sweep, plan, sim::SolverKnob::Substeps, {1, 2, 4}); !runs.empty())
    out.push_back(order_of("time step", runs, {1, 0.5, 0.25}, sweep.tank_length_m));
  return out;
}

}  // namespace

WaterErrors water_errors(const CellRun& run, const CellRun& reference, double tank_length_m) {
  const auto &a = run.samples, &b = reference.samples;
  if (a.size() != b.size() || a.empty())
    throw base::Error("the sweep", "has cells of different duration",
                      "give the --seconds with which the cells were run");
  double front = 0, centre = 0, kinetic = 0, density = 0, most_kinetic = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::abs(a[i].time_s - b[i].time_s) > 1e-9)
      throw base::Error("the sweep", "has cells that were sampled at different times",
                        "run the sweep again into a new file");
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
  out.floor = sweep.errors_of.at(&references[1]->run);
  out.floor[static_cast<std::size_t>(SweepError::Density)] = 0;
  out.parting_s = sweep.parting_s;
  out.orders = observed_orders(sweep, plan);
  const auto finer = finer_references(reference);
  for (const auto& setting : finer)
    if (const Group* group = sweep.find(setting)) out.finer.push_back(result_of(sweep, *group));
  for (const auto& group : sweep.groups) {
    const auto& setting = group.front()->cell.setting;
    if (setting == reference || std::find(finer.begin(), finer.end(), setting) != finer.end()) continue;
    out.settings.push_back(result_of(sweep, group));
  }
  for (const auto method : {sim::MethodKind::HiRes, sim::MethodKind::Ours}) {
    const Group* from = sweep.find(sim::usual_setting(plan.scene, method, plan.n_star));
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
    const double own = sweep.errors_of.at(sweep.reference)[e];
    for (const auto& one : out.finer) moved = std::max(moved, std::abs(one.errors[e].mean - own));
    out.converged[e] = out.finer.size() == finer.size() && std::isfinite(smallest) && moved < smallest / 3;
  }
  return out;
}

std::vector<std::size_t> pareto_front(const std::vector<SettingResult>& settings, SweepError error) {
  const auto value = [&](std::size_t i) { return settings[i].errors[static_cast<std::size_t>(error)].mean; };
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < settings.size(); ++i)
    if (!std::isnan(value(i))) order.push_back(i);
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
      out.push_back({list.settings[i].setting, seed, plan.seconds, plan.size, plan.kept});
  return out;
}

}  // namespace study
