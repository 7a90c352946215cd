#pragma once
/// A test's settings of the simulated headset: VIP_XR_PROFILE, "key=value;key=value". README.md lists the
/// keys.

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace simulated {

/// An event that the script triggers while the program waits for this frame.
struct ScriptedEvent {
  long frame = 0;  ///< counted over the whole process, from 0
  std::string name;
  double value = 1;
};

/// Properties of the headset and the runtime.
struct Profile {
  std::string runtime_name = "Simulated runtime";
  std::string headset_name = "Simulated headset";
  std::string headset = "connected";   ///< "connected", "unavailable" or "unsupported"
  std::string clock = "virtual";       ///< "virtual" or "real"
  std::string head = "still";          ///< "still", "turn" or "walk"
  std::string leave_context = "kept";  ///< context that GL calls leave current: "kept", "none" or "other"
  std::string look = "fixed";          ///< the eyes: "fixed", "sweep" or "page"
  std::string point = "fixed";         ///< the hand: "fixed" or "page"
  std::string controller = "khr/simple_controller";
  std::vector<std::pair<double, double>> targets;  ///< to point at on a page; fractions from left and top
  std::uint32_t width = 2064, height = 2208;       ///< px, recommended for each eye
  std::vector<std::string> extensions;
  std::vector<float> rates{72, 80, 90, 120};  ///< Hz, in the order in which they are listed
  float rate = 90;                            ///< Hz, current
  std::vector<std::int64_t> formats;          ///< GL internal formats, the preferred one first
  std::int64_t broken_format = 0;             ///< listed, but no swapchain of it can be made; 0: none
  std::vector<double> fov{-52, 42, 46, -50};  ///< degrees left, right, up, down of the left eye
  std::vector<long> dumps;                    ///< frames whose images are written to files
  std::map<std::string, double> knobs;        ///< values that the script may change, by name
  std::vector<ScriptedEvent> script;
  bool gaze = true;       ///< supportsEyeGazeInteraction
  bool presence = false;  ///< supportsUserPresence
  bool opaque = true;     ///< the opaque blend mode is offered besides the additive one
  bool stereo = true;
  bool positive = false;     ///< calls that may return a positive success code do so
  bool leave_error = false;  ///< calls that may use GL leave a GL error behind
  bool hash = false;         ///< the frame log has hashes of the images
};

/// Reads VIP_XR_PROFILE. std::invalid_argument for an unknown key, value or format.
Profile read_profile();

}  // namespace simulated
