#pragma once
/// Options of `vip-study run`, without the protocol. The database stores them as text, so that `vip-study
/// resume` needs only the database.

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace study {

struct RunOptions {
  std::string observer;                 ///< specification of a simulated observer; empty = a person
  std::string clock;                    ///< "real" or "virtual"
  std::string display;                  ///< "none", "headless", "window" or "openxr"
  int width_px = 640, height_px = 360;  ///< 0: the window fills its monitor
  int monitor = 0;                      ///< index of the monitor for --display window; 0: the primary monitor
  std::string bake;                     ///< absolute path of the played bake or folder of bakes; empty = none
  std::string backend = "auto";
  std::string answer;  ///< ways of answering in a headset, such as "ray,stick" (AnswerWays)
  /// "fixed" (the middle of the picture), "mouse", "head", "tracked", "none", or an eye tracker outside
  /// OpenXR (is_outside_tracker()).
  std::string gaze;
  std::array<double, 3> gaze_turn_deg{};  ///< fixed rotation of such a tracker's rays (rotation_of())
  bool ignore_presence = false;           ///< ignore the runtime's reports of whether the headset is worn
  bool light_patch = false;               ///< draw a patch for a light sensor (LightPatch)
  bool accept_slow = false;  ///< also play live cells that do not reach their frame rate on this machine
  std::string station;
  std::optional<double> screen_width_mm, viewing_distance_mm;
  std::vector<std::string> settings;  ///< solver settings of live cells (SessionSettings): full file texts

  bool operator==(const RunOptions&) const = default;
};

/// Formats the options as a JSON object. Its key "settings" has a list with an object for each solver
/// setting: text and sha256, which the exports read (libstudy/store/read/run_settings.hpp). The key is absent
/// without settings.
std::string format_run_options(const RunOptions& options);
/// Reads the text of format_run_options(); base::Error naming `place` for any other text.
RunOptions parse_run_options(const std::string& text, const std::string& place);

}  // namespace study
