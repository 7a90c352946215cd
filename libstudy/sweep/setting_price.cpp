#include "libstudy/sweep/setting_price.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "libsim/setting/named_scenes.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

/// Properties that are equal for all cells of a table: machine, program, SHA-256 of the scene file, scene,
/// seconds, size of timed pictures, size of stored pictures.
using Kind = std::tuple<std::string, std::string, std::string, std::string, double, std::string, std::string>;

Kind kind_of(const StoredCell& cell) {
  const auto& [machine, program, sha256] = cell.origin;
  return {machine,           program,        sha256,        cell.cell.setting.scene,
          cell.cell.seconds, cell.cell.size, cell.cell.kept};
}

/// n_* of each reference that was run from at least two starts.
std::vector<std::int64_t> references_in(const std::vector<const StoredCell*>& cells) {
  std::map<std::int64_t, int> starts;
  for (const auto* cell : cells) {
    const auto& setting = cell->cell.setting;
    const auto n_star = std::llround(setting[sim::SolverKnob::Size]);
    if (sim::to_text(setting) == sim::to_text(reference_setting(setting.scene, n_star))) ++starts[n_star];
  }
  std::vector<std::int64_t> out;
  for (const auto& [n_star, count] : starts)
    if (count >= 2) out.push_back(n_star);
  return out;
}

/// Length of the tank in the current scene file. base::Error if the sweep ran another version of the file.
double tank_length_m(const std::string& scene, const std::string& sha256) {
  const sim::Scene file = sim::scenes_of(scene).front().scene;
  if (file.sha256 != sha256)
    throw base::Error("scene " + scene, "has changed since the sweep was run", "run the sweep again");
  return file.tank_size_m[0];
}

std::string reason_of(const base::Error& error) {
  const std::string words = error.what();
  return words.substr(0, words.find('\n'));
}

std::vector<sim::SolverKnob> differing(const sim::SolverSetting& a, const sim::SolverSetting& b) {
  std::vector<sim::SolverKnob> out;
  for (const auto& traits : sim::solver_knobs()) {
    const sim::SolverKnob knob = traits.knob;
    if (sim::turns(knob, a.method) && sim::value_words(knob, a[knob]) != sim::value_words(knob, b[knob]))
      out.push_back(knob);
  }
  return out;
}

std::string value_or_rate(sim::SolverKnob knob, double value) {
  return std::isnan(value) ? "following the frame rate" : sim::value_words(knob, value);
}

/// The reason why no row has this setting. Names the knobs in which the setting differs from the most similar
/// row of the same method.
std::string why_no_row(const std::vector<const SweepTable*>& tables, const sim::SolverSetting& setting) {
  const SettingResult* nearest = nullptr;
  std::vector<sim::SolverKnob> least;
  for (const auto* table : tables) {
    for (const auto& row : table->list.settings) {
      if (row.setting.method != setting.method) continue;
      const auto knobs = differing(setting, row.setting);
      if (nearest && knobs.size() >= least.size()) continue;
      nearest = &row;
      least = knobs;
    }
  }
  const std::string method = sim::method_name(setting.method);
  if (!nearest) return "not measured: the sweep has no row of " + method;
  std::string out = "not measured: the sweep's nearest row of " + method + " differs in ";
  for (std::size_t i = 0; i < least.size(); ++i)
    out += fmt::format("{}{} (here {}, there {})", i ? ", " : "", sim::traits_of(least[i]).words,
                       value_or_rate(least[i], setting[least[i]]),
                       sim::value_words(least[i], nearest->setting[least[i]]));
  return out;
}

const SettingResult* row_of(const PriceList& list, const sim::SolverSetting& setting) {
  const std::string text = sim::to_text(setting);
  const auto found = std::find_if(list.settings.begin(), list.settings.end(),
                                  [&](const auto& row) { return sim::to_text(row.setting) == text; });
  return found == list.settings.end() ? nullptr : &*found;
}

std::string differences_in_words(const SettingResult& row, const SettingResult& hires) {
  std::string out;
  for (std::size_t e = 0; e < sweep_error_count; ++e) {
    const double by = row.errors[e].mean - hires.errors[e].mean;
    if (std::isnan(by)) continue;
    out += fmt::format("{}{} {:+.3g}", out.empty() ? "" : ", ", sweep_error_columns[e], by);
  }
  return out;
}

}  // namespace

SweepTables sweep_tables(const std::vector<StoredCell>& cells) {
  std::map<Kind, std::vector<const StoredCell*>> kinds;
  for (const auto& cell : cells) kinds[kind_of(cell)].push_back(&cell);
  SweepTables out;
  for (const auto& [kind, some] : kinds) {
    const auto& [machine, program, sha256, scene, seconds, picture, kept] = kind;
    const SweepOrigin origin{machine, program, sha256};
    const auto references = references_in(some);
    if (references.empty())
      out.left_out.push_back("the sweep of " + scene + " on " + origin.machine +
                             " has no finished reference with two starts yet");
    for (const auto n_star : references) {
      const SweepPlan plan{
          .scene = scene, .n_star = n_star, .seconds = seconds, .size = picture, .kept = kept};
      try {
        out.tables.push_back(
            {plan, price_list(cells, plan, origin, tank_length_m(scene, origin.scene_sha256))});
      } catch (const base::Error& error) {
        out.left_out.push_back(reason_of(error));
      }
    }
  }
  return out;
}

SweepTables read_sweep_tables(const std::filesystem::path& path) {
  return sweep_tables(SweepFile(path, sqlite::Open::Read).cells());
}

SettingPrices prices_of(const SweepTables& tables, sim::SolverSetting setting,
                        const std::string& scene_sha256) {
  SettingPrices out;
  std::vector<const SweepTable*> of_scene;
  for (const auto& table : tables.tables)
    if (table.list.origin.scene_sha256 == scene_sha256) of_scene.push_back(&table);
  if (of_scene.empty()) {
    out.why_none = "not measured: the sweep has no table of this scene file";
    for (const auto& why : tables.left_out) out.why_none += "; " + why;
    return out;
  }
  for (const auto* table : of_scene) {
    setting.scene = table->plan.scene;
    const SettingResult* row = row_of(table->list, setting);
    if (!row) continue;
    const auto hires = sim::usual_setting(setting.scene, sim::MethodKind::HiRes,
                                          std::llround(setting[sim::SolverKnob::Size]));
    out.found.push_back({table, row, row_of(table->list, hires)});
  }
  if (out.found.empty()) out.why_none = why_no_row(of_scene, setting);
  return out;
}

std::string errors_in_words(const std::array<Spread, sweep_error_count>& errors) {
  std::string out;
  for (std::size_t e = 0; e < sweep_error_count; ++e) {
    if (std::isnan(errors[e].mean)) continue;
    out += fmt::format("{}{} {}", out.empty() ? "" : ", ", sweep_error_columns[e], in_words(errors[e]));
  }
  return out;
}

std::vector<std::string> in_words(const SettingPrice& price) {
  const SettingResult& row = *price.row;
  const SweepPlan& plan = price.sweep->plan;
  std::vector<std::string> out{
      fmt::format("{:.2f} ms a frame, 95 % within {:.2f} ms ({})", row.ms_mean, row.ms_p95,
                  plan.size.empty() ? "the solver alone" : "with pictures of " + plan.size),
      errors_in_words(row.errors)};
  const std::string n_star = sim::value_words(sim::SolverKnob::Size, row.setting[sim::SolverKnob::Size]);
  if (!price.hires) {
    out.push_back("the sweep has no usual HiRes at n_* " + n_star + " to compare it with");
  } else if (price.hires == price.row) {
    out.push_back("it is HiRes at n_* " + n_star + ", which others are compared with");
  } else {
    out.push_back(fmt::format("{:.2f} times the time of HiRes at n_* {} ({:.2f} ms); {}",
                              row.ms_mean / price.hires->ms_mean, n_star, price.hires->ms_mean,
                              differences_in_words(row, *price.hires)));
  }
  out.push_back(fmt::format(
      "measured on {}, program {}; reference of n_* {}, {:.4g} s, {}", price.sweep->list.origin.machine,
      price.sweep->list.origin.program, plan.n_star, plan.seconds,
      plan.kept.empty() ? "no pictures compared" : "compared pictures of " + plan.kept));
  return out;
}

std::vector<std::string> in_words(const SettingPrices& prices) {
  if (prices.found.empty()) return {prices.why_none};
  std::vector<std::string> out;
  for (const auto& one : prices.found)
    for (auto& line : in_words(one)) out.push_back(std::move(line));
  return out;
}

}  // namespace study
