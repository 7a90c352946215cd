#include "libstudy/protocol/protocol.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/toml.hpp"

namespace study {

namespace {

constexpr base::Range fps_range{0.1, 1000};
constexpr base::Range duration_range{0.1, 3600};
constexpr base::Range tolerance_range{0, 1};
constexpr std::size_t most_settings = 1000;

std::string text_of(const base::TomlTable& table, std::string_view key) {
  const std::string value = table.string(key);
  if (value.find_first_not_of(" \t\r\n") == std::string::npos) table.fail(key, "is empty", "write a text");
  return value;
}

std::string shown(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

StimulusSpec read_stimulus(const base::TomlTable& table) {
  return {text_of(table, "scene"), text_of(table, "method"), text_of(table, "n_star")};
}

std::vector<double> distinct(const base::TomlTable& table, std::string_view key, base::Range range) {
  const auto values = table.numbers(key, 0, range);
  if (values.empty()) table.fail(key, "is empty", "name at least one value");
  auto sorted = values;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
    table.fail(key, "holds a value twice", "name each value once");
  return values;
}

std::vector<FpsSetting> read_settings(const base::TomlTable& table) {
  const auto means = distinct(table, "mean_fps", fps_range);
  const auto sds = distinct(table, "sd_fps", {0, fps_range.max});
  const double duration_s = table.number("duration_s", duration_range);
  if (means.size() * sds.size() > most_settings) {
    table.fail("mean_fps", "and sd_fps have more than " + std::to_string(most_settings) + " pairs",
               "name fewer values");
  }
  std::vector<FpsSetting> settings;
  for (const double mean : means) {
    for (const double sd : sds) {
      if (sd < mean) settings.push_back({mean, sd, duration_s});
    }
  }
  if (settings.empty())
    table.fail("sd_fps", "has no value below a mean", "name a standard deviation smaller than a mean");
  return settings;
}

void read_fps_max(const base::TomlTable& table, PacingRules& rules) {
  if (!table.has("fps_max")) return;
  if (table.is_text("fps_max")) {
    rules.fps_max_is_refresh = table.choice("fps_max", {"none", "refresh"}) == "refresh";
  } else {
    rules.fps_max = table.number("fps_max", fps_range);
  }
}

void read_order(const base::TomlTable& table, PacingRules& rules) {
  const std::string order =
      table.has("order") ? table.choice("order", {"white", "ar1", "trace"}) : std::string("white");
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

/// Cuts that no list of intervals with these means could keep.
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

PacingRules read_pacing(const base::TomlTable& table, const std::vector<FpsSetting>& settings) {
  PacingRules rules;
  if (table.has("mean") && table.choice("mean", {"harmonic", "arithmetic"}) == "arithmetic")
    rules.mean = FpsMean::Arithmetic;
  rules.fps_min = table.number("fps_min", fps_range);
  rules.max_interval_ms = table.number("max_interval_ms", {1, 10000});
  read_fps_max(table, rules);
  read_order(table, rules);
  check_cuts(table, rules, settings);
  return rules;
}

ContentRules read_content(const base::TomlTable& table) {
  ContentRules content;
  content.real_time = table.choice("mode", {"per_frame", "real_time"}) == "real_time";
  content.content_step_s = table.number("content_step_s", {1e-5, 1});
  content.start_frame = table.integer("start_frame", {0, 1e9});
  content.at_end = table.choice("at_end", {"loop", "hold"}) == "loop" ? AtEnd::Loop : AtEnd::Hold;
  return content;
}

TimingTolerance read_timing(const base::TomlTable& table) {
  TimingTolerance timing;
  timing.late_after_ms = table.number_or("late_after_ms", timing.late_after_ms, {0, 1000});
  timing.mean_relative = table.number_or("mean_relative", timing.mean_relative, tolerance_range);
  timing.sd_relative = table.number_or("sd_relative", timing.sd_relative, tolerance_range);
  timing.sd_absolute = table.number_or("sd_absolute_fps", timing.sd_absolute, {0, 100});
  timing.fail_mean_relative =
      table.number_or("fail_mean_relative", timing.fail_mean_relative, tolerance_range);
  timing.fail_sd_relative = table.number_or("fail_sd_relative", timing.fail_sd_relative, tolerance_range);
  timing.fail_sd_absolute = table.number_or("fail_sd_absolute_fps", timing.fail_sd_absolute, {0, 1000});
  if (timing.fail_mean_relative < timing.mean_relative)
    table.fail("fail_mean_relative", "is tighter than mean_relative", "make it at least as wide");
  if (timing.fail_sd_relative < timing.sd_relative)
    table.fail("fail_sd_relative", "is tighter than sd_relative", "make it at least as wide");
  if (timing.fail_sd_absolute < timing.sd_absolute)
    table.fail("fail_sd_absolute_fps", "is tighter than sd_absolute_fps", "make it at least as wide");
  return timing;
}

Question read_question(const base::TomlTable& table) {
  Question question;
  question.id = text_of(table, "id");
  question.language = text_of(table, "language");
  question.text = text_of(table, "text");
  question.scale_min = static_cast<int>(table.integer("scale_min", {0, 100}));
  question.scale_max = static_cast<int>(table.integer("scale_max", {0, 100}));
  if (question.scale_max <= question.scale_min)
    table.fail("scale_max", "is not above scale_min", "write the scale as low, high");
  const base::Range scale{static_cast<double>(question.scale_min), static_cast<double>(question.scale_max)};
  for (const auto& anchor : table.tables("anchor")) {
    const int score = static_cast<int>(anchor.integer("score", scale));
    if (!question.anchors.empty() && score <= question.anchors.back().first)
      anchor.fail("score", "does not ascend", "list the anchors in ascending order, each score once");
    question.anchors.emplace_back(score, text_of(anchor, "text"));
  }
  return question;
}

void check_format(const base::TomlTable& root) {
  if (root.integer("format") != Protocol::format_version) {
    root.fail("format",
              "is not the format this program reads (" + std::to_string(Protocol::format_version) + ")",
              "use the program that the protocol was written for");
  }
}

}  // namespace

Protocol parse_protocol(std::string_view text, const std::string& name) {
  const auto root = base::parse_toml(text, name);
  check_format(root);
  Protocol protocol;
  protocol.name = text_of(root, "name");
  protocol.version = text_of(root, "version");
  protocol.participants = static_cast<int>(root.integer("participants", {1, 100000}));
  protocol.accept_approximate = root.boolean_or("accept_approximate", false);
  protocol.stimulus = read_stimulus(root.table("stimulus"));
  const auto design = root.table("design");
  protocol.settings = read_settings(design);
  protocol.gap_s = design.number("gap_s", {0, 600});
  protocol.pacing = read_pacing(root.table("pacing"), protocol.settings);
  protocol.content = read_content(root.table("content"));
  if (root.has("timing")) protocol.timing = read_timing(root.table("timing"));
  protocol.question = read_question(root.table("question"));
  root.finish();
  protocol.text = text;
  protocol.sha256 = base::sha256_hex(text);
  return protocol;
}

Protocol read_protocol(const std::filesystem::path& path) {
  return parse_protocol(base::read_file(path, 1 << 20), path.string());
}

void override_trial_seconds(Protocol& protocol, double seconds) {
  if (!(seconds >= duration_range.min && seconds <= duration_range.max)) {
    throw base::Error("--trial-seconds", shown(seconds) + " s is out of range",
                      "use " + shown(duration_range.min) + " to " + shown(duration_range.max) + " s");
  }
  char line[64];
  std::snprintf(line, sizeof line, "\n# override: trial_seconds = %.17g\n", seconds);
  for (auto& setting : protocol.settings) setting.duration_s = seconds;
  protocol.trial_seconds = seconds;
  protocol.test_data = true;
  protocol.sha256 = base::sha256_hex(protocol.text + line);
}

}  // namespace study
