#pragma once
/// Options of `vip-study run` besides the protocol, stored in the database as text, so that `resume` needs
/// only the database.

#include <optional>
#include <string>
#include <vector>

namespace study {

struct RunOptions {
  std::string observer;                 ///< specification of a simulated observer; empty = a person
  std::string clock;                    ///< "real" or "virtual"
  std::string display;                  ///< "none", "headless", "window" or "openxr"
  int width_px = 640, height_px = 360;  ///< 0: the whole monitor of a window
  int monitor = 0;                      ///< of a window; 0: the primary one
  std::string bake;                     ///< absolute path of the bake played; empty = none
  std::string backend = "auto";
  std::string answer;        ///< ways of answering in a headset: see AnswerWays
  std::string gaze;          ///< "fixed" (the middle of the picture), "mouse", "head", "tracked" or "none"
  bool accept_slow = false;  ///< also play live cells that miss their setting on this machine
  std::string station;
  std::optional<double> screen_width_mm, viewing_distance_mm;
  std::vector<std::string> settings;  ///< solver settings of live cells (SessionSettings): full file texts

  bool operator==(const RunOptions&) const = default;
};

/// JSON. "settings" has an object with text and sha256 for each setting, as read by the exports
/// (libstudy/store/read/run_settings.hpp); the key is absent without settings.
std::string format_run_options(const RunOptions& options);
/// base::Error naming `place` for anything that format_run_options() does not write.
RunOptions parse_run_options(const std::string& text, const std::string& place);

}  // namespace study
