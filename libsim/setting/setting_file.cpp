#include "libsim/setting/setting_file.hpp"

#include <fmt/core.h>

#include "libsim/methods/method.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"
#include "stats/base/toml.hpp"

namespace sim {

namespace {

std::vector<std::string> method_names() {
  std::vector<std::string> out;
  for (const auto& method : all_methods()) out.push_back(method_name(method.kind));
  return out;
}

SolverSetting setting_of(const base::TomlTable& table) {
  const auto method = parse_method(table.choice("method", method_names()));
  SolverSetting out = usual_setting(table.string("scene"), method, 1);
  for (const auto& traits : solver_knobs()) {
    if (!turns(traits.knob, method)) continue;
    const base::Range range{traits.least, traits.most};
    out[traits.knob] = traits.whole ? static_cast<double>(table.integer(traits.column, range))
                                    : table.number(traits.column, range);
  }
  return out;
}

SettingFile::Measured measured_of(const base::TomlTable& table) {
  SettingFile::Measured out;
  out.machine = table.string("machine");
  out.program = table.string("program");
  out.scene_sha256 = table.string("scene_sha256");
  out.picture = table.string("picture");
  out.seconds = table.number("seconds", base::positive);
  out.budget_ms = table.number("budget_ms", base::positive);
  out.ms_mean = table.number("ms_mean", base::non_negative);
  out.ms_p95 = table.number("ms_p95", base::non_negative);
  out.error = table.string("error");
  out.error_pct = table.number("error_pct", base::non_negative);
  out.error_low_pct = table.number("error_low_pct", base::non_negative);
  out.error_high_pct = table.number("error_high_pct", base::non_negative);
  out.seeds = static_cast<int>(table.integer("seeds", {1, 1e6}));
  out.date_utc = table.string("date_utc");
  return out;
}

}  // namespace

std::string describe(const SettingFile& file) {
  const auto& m = file.measured;
  return fmt::format("{}: {:.2f} ms in 95 % of the frames{}, {} {:.3g} [{:.3g}, {:.3g}], measured on {} ({})",
                     to_text(file.setting), m.ms_p95,
                     m.picture == "none" ? " (the solver alone)" : " with pictures", m.error, m.error_pct,
                     m.error_low_pct, m.error_high_pct, m.machine, m.date_utc);
}

std::string other_scene(const SettingFile& file, const std::string& scene_sha256) {
  if (file.measured.scene_sha256 == scene_sha256) return {};
  return "note: the setting was measured on another scene file than this; its milliseconds and error are "
         "not this scene's";
}

SettingFile parse_setting_file(std::string_view text, const std::string& name) {
  const auto root = base::parse_toml(text, name);
  if (const auto format = root.integer("format"); format != SettingFile::format_version) {
    root.fail("format",
              "= " + std::to_string(format) + " is not the format this program reads (" +
                  std::to_string(SettingFile::format_version) + ")",
              "use the version of the program that wrote the file, or write a new one with vip-bench "
              "accuracy --budget");
  }
  SettingFile out{setting_of(root.table("setting")), measured_of(root.table("measured"))};
  root.finish();
  return out;
}

SettingFile read_setting_file(const std::filesystem::path& path) {
  return parse_setting_file(base::read_file(path, 1 << 20), path.string());
}

std::string format_setting_file(const SettingFile& file) {
  std::string out = fmt::format(
      "# Chosen by vip-bench accuracy --budget. Programs take it as --setting.\nformat = {}\n\n"
      "[setting]\nscene = {}\nmethod = {}\n",
      SettingFile::format_version, base::toml_quoted(file.setting.scene),
      base::toml_quoted(method_name(file.setting.method)));
  for (const auto& traits : solver_knobs()) {
    if (!turns(traits.knob, file.setting.method)) continue;
    const double value = file.setting[traits.knob];
    out += fmt::format("{} = {}\n", traits.column,
                       traits.whole ? fmt::format("{:.0f}", value) : base::shortest(value));
  }
  const auto& m = file.measured;
  out += fmt::format(
      "\n[measured]\nmachine = {}\nprogram = {}\nscene_sha256 = {}\npicture = {}\nseconds = {}\n"
      "budget_ms = {}\nms_mean = {}\nms_p95 = {}\nerror = {}\nerror_pct = {}\nerror_low_pct = {}\n"
      "error_high_pct = {}\nseeds = {}\ndate_utc = {}\n",
      base::toml_quoted(m.machine), base::toml_quoted(m.program), base::toml_quoted(m.scene_sha256),
      base::toml_quoted(m.picture), base::shortest(m.seconds), base::shortest(m.budget_ms),
      base::shortest(m.ms_mean), base::shortest(m.ms_p95), base::toml_quoted(m.error),
      base::shortest(m.error_pct), base::shortest(m.error_low_pct), base::shortest(m.error_high_pct), m.seeds,
      base::toml_quoted(m.date_utc));
  return out;
}

}  // namespace sim
