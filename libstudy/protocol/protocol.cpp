#include "libstudy/protocol/protocol.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libstudy/protocol/readers.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

constexpr base::Range tolerance_range{0, 1};

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
  if (table.has("overrun_s")) timing.overrun_s = table.number("overrun_s", pause_range);
  if (timing.fail_mean_relative < timing.mean_relative)
    table.fail("fail_mean_relative",
               "= " + shown(timing.fail_mean_relative) +
                   " is tighter than mean_relative = " + shown(timing.mean_relative),
               "make it at least as wide");
  if (timing.fail_sd_relative < timing.sd_relative)
    table.fail(
        "fail_sd_relative",
        "= " + shown(timing.fail_sd_relative) + " is tighter than sd_relative = " + shown(timing.sd_relative),
        "make it at least as wide");
  if (timing.fail_sd_absolute < timing.sd_absolute)
    table.fail("fail_sd_absolute_fps",
               "= " + shown(timing.fail_sd_absolute) +
                   " is tighter than sd_absolute_fps = " + shown(timing.sd_absolute),
               "make it at least as wide");
  return timing;
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
    if (rules.trace_rates.size() < 2)
      table.fail("trace_fps", "has fewer than two rates", "give at least two rates");
  } else if (table.has("trace_fps")) {
    table.fail("trace_fps", "needs order = \"trace\"", "change the order or remove trace_fps");
  }
}

/// Refuses bounds on the frame rate that contradict each other or the settings' means.
void check_cuts(const base::TomlTable& table, const PacingRules& rules,
                const std::vector<FpsSetting>& settings) {
  // The relative margin accepts a limit that was written with a few digits, such as 333.333 for fps_min = 3.
  if (rules.max_interval_ms < 1000 / rules.fps_min * (1 - 1e-5)) {
    table.fail("max_interval_ms",
               "contradicts fps_min = " + shown(rules.fps_min) + ", which allows " +
                   shown(1000 / rules.fps_min) + " ms",
               "raise max_interval_ms to " + shown(1000 / rules.fps_min) + " or fps_min to " +
                   shown(1000 / rules.max_interval_ms));
  }
  if (rules.fps_max && *rules.fps_max < rules.fps_min)
    table.fail("fps_max", "= " + shown(*rules.fps_max) + " is below fps_min = " + shown(rules.fps_min),
               "raise fps_max or lower fps_min");
  for (const auto& setting : settings) {
    const bool below = setting.sd > 0 ? setting.mean <= rules.fps_min : setting.mean < rules.fps_min;
    if (below) {
      table.fail("fps_min", "= " + shown(rules.fps_min) + " excludes the setting " + setting_name(setting),
                 "lower fps_min or remove the setting");
    }
    const double top = rules.fps_max.value_or(HUGE_VAL);
    if (setting.sd > 0 ? setting.mean >= top : setting.mean > top) {
      table.fail("fps_max", "= " + shown(top) + " excludes the setting " + setting_name(setting),
                 "raise fps_max or remove the setting");
    }
  }
}

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
    if (design.timing != TimingSource::Native && !has_pattern(cell.setting)) settings.push_back(cell.setting);
  }
  check_cuts(table, rules, settings);
  return rules;
}

HeadsetRules read_headset(const base::TomlTable& table) {
  HeadsetRules rules;
  const std::string hold = table.choice_or("hold", "image", {"image", "state", "head_locked"});
  rules.hold = hold == "state" ? Hold::State : hold == "head_locked" ? Hold::HeadLocked : Hold::Image;
  const auto acknowledged =
      table.has("acknowledge") ? distinct_words(table, "acknowledge") : std::vector<std::string>();
  for (std::size_t i = 0; i < acknowledged.size(); ++i) {
    if (acknowledged[i] == "head_locked") continue;
    table.fail_at("acknowledge", i, "= " + base::toml_quoted(acknowledged[i]) + " cannot be acknowledged",
                  base::use_one_of(acknowledged[i], {"head_locked"}));
  }
  const bool knows = std::find(acknowledged.begin(), acknowledged.end(), "head_locked") != acknowledged.end();
  if (rules.hold == Hold::HeadLocked && !knows) {
    table.fail("hold", "= \"head_locked\" moves the world with the head, which makes people sick",
               "use image or state, or add acknowledge = [\"head_locked\"]");
  }
  rules.hold_margin_deg = table.number_or("hold_margin_deg", 0, {0, 30});
  if (rules.hold != Hold::Image && rules.hold_margin_deg > 0)
    table.fail("hold_margin_deg", "has an effect with hold = \"image\" only",
               "remove it, or write hold = \"image\"");
  rules.world_scale = table.number_or("world_scale", 1, {0.01, 100});
  if (table.has("refresh_hz")) rules.refresh_hz = table.number("refresh_hz", {10, 1000});
  return rules;
}

int read_format(const base::TomlTable& root) {
  const std::int64_t format = root.integer("format");
  if (format != 2 && format != Protocol::newest_format) {
    root.fail("format",
              "= " + std::to_string(format) + " is neither of the formats that this program reads (2 and 3)",
              "use the program that the protocol was written for");
  }
  return static_cast<int>(format);
}

/// base::Error if a cell has a latency or an animation error and the mode of the content is not real_time: in
/// mode per_frame, the time of the content cannot differ from the time of the display.
void check_content(const base::TomlTable& table, const ContentRules& content, const Design& design) {
  for (const Cell& cell : design.cells) {
    const auto& profile = cell.setting.profile;
    if (content.real_time || !profile) continue;
    if (profile->latency_ms > 0 || profile->animation_error_ms > 0)
      table.fail("mode",
                 "= \"per_frame\" ties the content to the frames, so it cannot lag behind the display: " +
                     profile_text(*profile),
                 "write mode = \"real_time\", or remove latency_ms and animation_error_ms");
  }
}

}  // namespace

std::string text_of(const base::TomlTable& table, std::string_view key) {
  const std::string value = table.string(key);
  if (base::is_blank(value)) table.fail(key, "is empty", "write a text");
  return value;
}

std::string shown(double value) { return fmt::format("{:g}", value); }

bool is_id(std::string_view word) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto good = [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; };
  return !word.empty() && letter(word.front()) && word.size() <= 64 &&
         std::all_of(word.begin(), word.end(), good);
}

std::string id_of(const base::TomlTable& table, std::string_view key) {
  const std::string id = text_of(table, key);
  if (!is_id(id)) {
    table.fail(key, "= " + base::toml_quoted(id) + " is no id",
               "write a letter, then letters, digits and '_', 64 at most");
  }
  return id;
}

Protocol read_protocol_table(const base::TomlTable& root, ProtocolUse use) {
  Protocol protocol;
  protocol.format = read_format(root);
  protocol.name = text_of(root, "name");
  protocol.version = text_of(root, "version");
  protocol.language = text_of(root, "language");
  protocol.participants = static_cast<int>(root.integer("participants", {1, 100000}));
  protocol.accept_approximate = root.boolean_or("accept_approximate", false);
  protocol.accept_mixed_pictures = root.boolean_or("accept_mixed_pictures", false);
  protocol.fixation = root.choice_or("gaze", "free", {"free", "fixation"}) == "fixation";
  protocol.needs_gaze = root.boolean_or("needs_gaze", false);
  protocol.true_angle = root.choice_or("camera_angle", "scene", {"scene", "true"}) == "true";
  const auto design = root.table("design");
  if (protocol.format == 2 && use == ProtocolUse::New) check_design_names(design);
  std::optional<base::TomlTable> procedure;
  if (protocol.format == 3 && root.has("procedure")) procedure = root.table("procedure");
  protocol.design = protocol.format == 2
                        ? read_design(design)
                        : read_factor_design(root, design, procedure ? &*procedure : nullptr);
  protocol.pacing = read_pacing(root.table("pacing"), protocol.design);
  const auto content = root.table("content");
  protocol.content = read_content(content);
  check_content(content, protocol.content, protocol.design);
  if (root.has("timing")) protocol.timing = read_timing(root.table("timing"));
  if (root.has("headset")) protocol.headset = read_headset(root.table("headset"));
  protocol.blocks = read_blocks(root, protocol.design, protocol.language, use);
  if (procedure) check_procedure_question(*procedure, protocol.design, protocol.blocks);
  return protocol;
}

Protocol parse_protocol(std::string_view text, const std::string& name, ProtocolUse use) {
  const auto root = base::parse_toml(text, name);
  Protocol protocol = read_protocol_table(root, use);
  root.finish();
  protocol.place = name;
  protocol.text = text;
  protocol.sha256 = base::sha256_hex(text);
  return protocol;
}

Protocol read_protocol(const std::filesystem::path& path) {
  return parse_protocol(base::read_file(path, 1 << 20), path.string());
}

const char* hold_name(Hold hold) {
  constexpr const char* names[] = {"image", "state", "head_locked"};
  return names[static_cast<int>(hold)];
}

std::vector<std::pair<int, const Question*>> all_questions(const Protocol& protocol) {
  std::vector<std::pair<int, const Question*>> out;
  for (std::size_t i = 0; i < protocol.blocks.size(); ++i) {
    for (const Question& question : protocol.blocks[i].questions)
      out.emplace_back(static_cast<int>(i), &question);
  }
  return out;
}

void override_trial_seconds(Protocol& protocol, double seconds) {
  if (!(seconds >= duration_range.min && seconds <= duration_range.max)) {
    throw base::Error("--trial-seconds", shown(seconds) + " s is out of range",
                      "use " + shown(duration_range.min) + " to " + shown(duration_range.max) + " s");
  }
  for (auto& cell : protocol.design.cells) {
    FpsSetting& setting = cell.setting;
    setting.duration_s = seconds;
    if (setting.profile) setting = setting_of(*setting.profile, seconds);
  }
  protocol.trial_seconds = seconds;
  protocol.test_data = true;
  protocol.sha256 =
      base::sha256_hex(protocol.text + fmt::format("\n# override: trial_seconds = {:.17g}\n", seconds));
}

}  // namespace study
