#pragma once
/// What `vip-study run` was asked for, beyond the protocol: kept in the database as text, so that `resume`
/// needs nothing but the database.

#include <optional>
#include <string>
#include <vector>

namespace apps {

struct RunOptions {
  std::string observer;                 ///< specification of a simulated observer; empty = a person
  std::string clock;                    ///< "real" or "virtual"
  std::string display;                  ///< "none", "headless", "window" or "openxr"
  int width_px = 640, height_px = 360;  ///< 0: the whole monitor of a window
  int monitor = 0;                      ///< of a window; 0: the primary one
  std::string bake;                     ///< absolute path of the bake played; empty = none
  std::string backend = "auto";
  std::string answer;        ///< of a person in a headset: see AnswerWays
  std::string gaze;          ///< "fixed": the middle of the picture, "mouse", or "none": not known
  bool accept_slow = false;  ///< live cells that this machine does not show at their setting are played
  std::string station;
  std::optional<double> screen_width_mm, viewing_distance_mm;
  std::vector<std::string> settings;  ///< solver settings of live cells (SessionSettings), each file in full

  bool operator==(const RunOptions&) const = default;
};

/// JSON. "settings" holds an object for each, with its text and its sha256, as the exports read them
/// (libstudy/store/run_settings.hpp); without any the key is absent.
std::string format_run_options(const RunOptions& options);
/// base::Error naming `place` for anything that format_run_options() does not write.
RunOptions parse_run_options(const std::string& text, const std::string& place);

}  // namespace apps
