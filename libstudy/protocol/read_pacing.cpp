#include <cmath>

#include "libstudy/protocol/readers.hpp"

namespace study {

namespace {

void read_fps_max(const base::TomlTable& table, PacingRules& rules) {
  if (!table.has("fps_max")) return;
  if (table.is_text("fps_max")) {
    rules.fps_max_is_refresh = table.choice("fps_max", {"none", "refresh"}) == "refresh";
  } else {
    rules.fps_max = table.number("fps_max", fps_range);
  }
}

void read_order(const base::TomlTable& table, PacingRules& rules) {
  const std::string order = table.choice_or("order", "white", {"white", "ar1", "trace"});
  if (order == "ar1") {
    rules.order = FrameOrder::Ar1;
    rules.ar1 = table.number("ar1", {-0.99, 0.99});
  } else if (table.has("ar1")) {
    table.fail("ar1", "needs order = \"ar1\"", "change the order or remove ar1");
  }
  if (order == "trace") {
    rules.order = FrameOrder::Trace;
    rules.trace_rates = table.numbers("trace_fps", 0, base::positive);
    if (rules.trace_rates.size() < 2) table.fail("trace_fps", "is too short", "give at least two rates");
  } else if (table.has("trace_fps")) {
    table.fail("trace_fps", "needs order = \"trace\"", "change the order or remove trace_fps");
  }
}

/// Refuses bounds that no list of intervals with these means can satisfy.
void check_cuts(const base::TomlTable& table, const PacingRules& rules,
                const std::vector<FpsSetting>& settings) {
  // A relative margin for a limit that was written with a few digits, such as 333.333 for fps_min = 3.
  if (rules.max_interval_ms < 1000 / rules.fps_min * (1 - 1e-5)) {
    table.fail("max_interval_ms",
               "contradicts fps_min = " + shown(rules.fps_min) + ", which allows " +
                   shown(1000 / rules.fps_min) + " ms",
               "raise max_interval_ms to " + shown(1000 / rules.fps_min) + " or fps_min to " +
                   shown(1000 / rules.max_interval_ms));
  }
  if (rules.fps_max && *rules.fps_max < rules.fps_min)
    table.fail("fps_max", "is below fps_min = " + shown(rules.fps_min), "raise fps_max or lower fps_min");
  for (const auto& setting : settings) {
    const bool below = setting.sd > 0 ? setting.mean <= rules.fps_min : setting.mean < rules.fps_min;
    if (below) {
      table.fail("fps_min", "= " + shown(rules.fps_min) + " leaves no room for " + setting_name(setting),
                 "lower fps_min or remove the setting");
    }
    const double top = rules.fps_max.value_or(HUGE_VAL);
    if (setting.sd > 0 ? setting.mean >= top : setting.mean > top) {
      table.fail("fps_max", "= " + shown(top) + " leaves no room for " + setting_name(setting),
                 "raise fps_max or remove the setting");
    }
  }
}

}  // namespace

PacingRules read_pacing(const base::TomlTable& table, const Design& design) {
  PacingRules rules;
  if (table.choice_or("mean", "harmonic", {"harmonic", "arithmetic"}) == "arithmetic")
    rules.mean = FpsMean::Arithmetic;
  rules.fps_min = table.number("fps_min", fps_range);
  rules.max_interval_ms = table.number("max_interval_ms", {1, 10000});
  read_fps_max(table, rules);
  read_order(table, rules);
  std::vector<FpsSetting> settings;
  for (const Cell& cell : design.cells) {
    if (design.timing != TimingSource::Native) settings.push_back(cell.setting);
  }
  check_cuts(table, rules, settings);
  return rules;
}

}  // namespace study
