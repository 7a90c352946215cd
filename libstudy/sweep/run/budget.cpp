#include "libstudy/sweep/run/budget.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <charconv>
#include <cmath>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/timing.hpp"

namespace study {

namespace {

constexpr int fresh_starts = 2;

std::string named(const sim::SolverSetting& setting) {
  return sim::method_name(setting.method) + ", " + in_words(setting);
}

/// Runs a setting with seeds that no cell of the sweep has.
std::vector<StoredCell> run_afresh(const sim::SolverSetting& setting, const std::vector<StoredCell>& cells,
                                   const SweepPlan& plan,
                                   const std::function<StoredCell(const SweepCell&)>& run) {
  int last = 0;
  for (const auto& cell : cells) last = std::max(last, cell.cell.seed);
  std::vector<StoredCell> out;
  for (int start = 1; start <= fresh_starts; ++start)
    out.push_back(run({setting, last + start, plan.seconds, plan.size, plan.kept}));
  return out;
}

std::vector<double> frame_ms(const std::vector<StoredCell>& cells) {
  std::vector<double> out;
  for (const auto& cell : cells)
    for (const auto& frame : cell.run.frames) out.push_back(frame.all_ms());
  return out;
}

/// `cells` with the cells in `more` inserted behind the last cell of the same setting.
std::vector<StoredCell> joined(std::vector<StoredCell> cells, const std::vector<StoredCell>& more) {
  const std::string text = sim::to_text(more.front().cell.setting);
  const auto last = std::find_if(cells.rbegin(), cells.rend(), [&](const auto& cell) {
    return cell.origin == more.front().origin && sim::to_text(cell.cell.setting) == text;
  });
  cells.insert(last.base(), more.begin(), more.end());
  return cells;
}

sim::SettingFile file_of(const SettingResult& all, const std::vector<StoredCell>& fresh,
                         const BudgetRequest& request) {
  const auto e = static_cast<std::size_t>(request.error);
  const auto ms = frame_ms(fresh);
  const auto& origin = fresh.front().origin;
  sim::SettingFile out{all.setting, {}};
  out.measured = {.machine = origin.machine,
                  .program = origin.program,
                  .scene_sha256 = origin.scene_sha256,
                  .picture = request.plan.size.empty() ? "none" : request.plan.size,
                  .seconds = request.plan.seconds,
                  .budget_ms = request.budget_ms,
                  .ms_mean = 0,
                  .ms_p95 = base::quantile(ms, 0.95),
                  .error = sweep_error_columns[e],
                  .error_pct = all.errors[e].mean,
                  .error_low_pct = all.errors[e].low,
                  .error_high_pct = all.errors[e].high,
                  .seeds = all.seeds,
                  .date_utc = base::utc_now()};
  for (const double one : ms) out.measured.ms_mean += one / static_cast<double>(ms.size());
  return out;
}

[[noreturn]] void refuse(const BudgetRequest& request, const std::string& who, double ms, const char* when) {
  throw base::Error(
      fmt::format("--budget {:.4g}ms", request.budget_ms),
      fmt::format("is met by no setting of the sweep{}. Nearest is {}: {:.2f} ms in 95 % of its frames, "
                  "{:.2f} ms above the budget",
                  when, who, ms, ms - request.budget_ms),
      fmt::format("allow {:.2f}ms, or sweep smaller sizes (--n-star)", std::ceil(ms * 100) / 100));
}

bool requested(const sim::SolverSetting& setting, const BudgetRequest& request) {
  return (!request.method || setting.method == *request.method) &&
         (!request.n_star || setting[sim::SolverKnob::Size] == static_cast<double>(*request.n_star)) &&
         (!request.frames_per_s || setting[sim::SolverKnob::Rate] == *request.frames_per_s);
}

/// The settings that have the requested method, n_* and rate, and for which the requested error is known.
/// base::Error if there are none.
std::vector<SettingResult> candidates(const PriceList& list, const BudgetRequest& request) {
  const auto e = static_cast<std::size_t>(request.error);
  std::vector<SettingResult> out;
  for (const auto& one : list.settings)
    if (requested(one.setting, request)) out.push_back(one);
  if (out.empty()) {
    throw base::Error("--of-method, --of-n-star, --of-rate", "match no setting of the sweep",
                      "give values that --csv lists, or sweep another n_* with --n-star");
  }
  std::erase_if(out, [&](const auto& one) { return std::isnan(one.errors[e].mean); });
  if (out.empty()) {
    throw base::Error("--error " + sweep_error_names()[e],
                      "is not known for any setting: " + why_no_price(list),
                      "ask for another error, or sweep with --pictures 240x135");
  }
  return out;
}

}  // namespace

double parse_budget(const std::string& words) {
  double out = 0;
  const char* const end = words.data() + words.size();
  const auto [rest, problem] = std::from_chars(words.data(), end, out);
  if (problem != std::errc{} || std::string_view(rest, end) != "ms" || !(out > 0) || !(out < 1e6))
    throw base::Error("--budget " + words, "is not a frame time in ms",
                      "write a positive number with its unit, such as 11.1ms");
  return out;
}

const std::vector<std::string>& sweep_error_names() {
  static const std::vector<std::string> out = [] {
    std::vector<std::string> names;
    for (const std::string column : sweep_error_columns) names.push_back(column.substr(0, column.find('_')));
    return names;
  }();
  return out;
}

SweepError parse_sweep_error(const std::string& word) {
  const auto& names = sweep_error_names();
  return static_cast<SweepError>(std::find(names.begin(), names.end(), word) - names.begin());
}

std::vector<std::size_t> within_budget(const std::vector<SettingResult>& settings, double budget_ms,
                                       SweepError error) {
  const auto of = [&](std::size_t i) { return settings[i].errors[static_cast<std::size_t>(error)]; };
  std::vector<std::size_t> left, out;
  for (std::size_t i = 0; i < settings.size(); ++i)
    if (settings[i].ms_p95 > 0 && settings[i].ms_p95 <= budget_ms && !std::isnan(of(i).mean))
      left.push_back(i);
  while (!left.empty()) {
    const std::size_t least = *std::min_element(
        left.begin(), left.end(), [&](std::size_t a, std::size_t b) { return of(a).mean < of(b).mean; });
    std::size_t choice = least;
    for (const std::size_t i : left)
      if (of(i).low <= of(least).high && settings[i].ms_mean < settings[choice].ms_mean) choice = i;
    out.push_back(choice);
    std::erase(left, choice);
  }
  return out;
}

sim::SettingFile choose_setting(const std::vector<StoredCell>& cells, const SweepOrigin& origin,
                                const BudgetRequest& request,
                                const std::function<StoredCell(const SweepCell&)>& run,
                                const std::function<void(const std::string&)>& said) {
  const auto list = price_list(cells, request.plan, origin, request.tank_length_m);
  const auto settings = candidates(list, request);
  const auto order = within_budget(settings, request.budget_ms, request.error);
  if (order.empty()) {
    const SettingResult* nearest = nullptr;
    for (const auto& one : settings)
      if (one.ms_p95 > 0 && (!nearest || one.ms_p95 < nearest->ms_p95)) nearest = &one;
    if (!nearest) throw base::Error("the sweep", "has no timed setting", "run it with a longer --seconds");
    refuse(request, named(nearest->setting), nearest->ms_p95, "");
  }
  std::string nearest;
  double nearest_ms = 0;
  for (const std::size_t i : order) {
    const auto& setting = settings[i].setting;
    const auto fresh = run_afresh(setting, cells, request.plan, run);
    const double p95 = base::quantile(frame_ms(fresh), 0.95);
    if (p95 <= request.budget_ms) {
      const auto all = price_list(joined(cells, fresh), request.plan, origin, request.tank_length_m);
      const auto found = std::find_if(all.settings.begin(), all.settings.end(),
                                      [&](const auto& one) { return one.setting == setting; });
      return file_of(*found, fresh, request);
    }
    said(fmt::format("{}: {:.2f} ms when measured anew, more than the budget", named(setting), p95));
    if (nearest.empty() || p95 < nearest_ms) {
      nearest = named(setting);
      nearest_ms = p95;
    }
  }
  refuse(request, nearest, nearest_ms, " when measured anew");
}

}  // namespace study
