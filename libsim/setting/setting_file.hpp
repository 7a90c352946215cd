#pragma once
/// The file of a solver setting, such as best.toml, that `vip-bench accuracy --budget` chose and that
/// programs take as --setting.

#include <filesystem>
#include <string>
#include <string_view>

#include "libsim/setting/solver_setting.hpp"

namespace sim {

struct SettingFile {
  static constexpr int format_version = 1;

  /// Why the setting was chosen, and its cost on the machine that measured it.
  struct Measured {
    std::string machine, program, scene_sha256;
    std::string picture;   ///< size of the picture drawn in each frame; "none" = only the solver was timed
    double seconds = 0;    ///< seconds of fluid time per run
    double budget_ms = 0;  ///< limit that 95 % of the frames had to meet
    double ms_mean = 0;    ///< mean time of a whole frame, over fresh starts
    double ms_p95 = 0;     ///< 95th percentile of the time of a whole frame
    std::string error;     ///< name of the error that was minimised, such as "centre_pct"
    double error_pct = 0;  ///< `error` against the sweep's reference run, mean over all starts
    double error_low_pct = 0, error_high_pct = 0;  ///< smallest and largest over the starts
    int seeds = 0;                                 ///< number of starts
    std::string date_utc;
  };

  SolverSetting setting;
  Measured measured;
};

/// One line: the setting, its milliseconds, its error and the machine.
std::string describe(const SettingFile& file);
/// A note that the setting was measured on another scene file; empty if it was measured on the file with this
/// SHA-256.
std::string other_scene(const SettingFile& file, const std::string& scene_sha256);

/// Errors (base::Error at file:line:column): a missing or unknown key, a wrong type or range, another format.
SettingFile parse_setting_file(std::string_view text, const std::string& name);
SettingFile read_setting_file(const std::filesystem::path& path);
/// The text of a file that parse_setting_file reads back to the same values.
std::string format_setting_file(const SettingFile& file);

}  // namespace sim
