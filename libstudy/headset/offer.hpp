#pragma once
/// The properties of a headset and its runtime that matter to a study.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace study {

/// Size of one eye's picture that the runtime recommends, px.
struct EyePicture {
  std::uint32_t width = 0, height = 0;
  friend bool operator==(const EyePicture&, const EyePicture&) = default;
};

struct HeadsetOffer {
  std::string runtime, runtime_version;  ///< version in the numbering of the runtime
  std::string headset;
  std::vector<std::string> extensions;  ///< names, in ascending order
  std::vector<EyePicture> eyes;         ///< left and right
  bool opaque = false;                  ///< the picture can hide the real world
  bool position = false;                ///< the head's position is tracked, not only its direction
  bool eye_gaze = false;                ///< an eye tracker is available (XR_EXT_eye_gaze_interaction)
  bool user_presence = false;           ///< the runtime reports whether somebody wears the headset
  bool time_converts = false;           ///< the runtime's times can be converted to the system's clock
  /// Properties that only a session reports. None if no OpenGL context for a session could be made;
  /// `no_session` gives the reason.
  struct InSession {
    std::vector<double> refresh_hz;     ///< ascending; empty: not reported
    std::optional<double> refresh_now;  ///< Hz; read only if several rates are listed
    std::vector<std::int64_t> formats;  ///< GL internal formats in the runtime's order of preference
  };
  std::optional<InSession> session;
  std::string no_session;
};

/// Connects to the headset, reads the properties and disconnects. base::Error if there is no loader, runtime,
/// headset or pair of views, or if a call fails.
HeadsetOffer read_headset_offer();

}  // namespace study
