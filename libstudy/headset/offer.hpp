#pragma once
/// The properties of a headset and its runtime that matter to a study.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace study {

/// One eye's picture as the runtime recommends it, px.
struct EyePicture {
  std::uint32_t width = 0, height = 0;
  friend bool operator==(const EyePicture&, const EyePicture&) = default;
};

struct HeadsetOffer {
  std::string runtime, runtime_version;  ///< the version in the runtime's own numbering
  std::string headset;
  std::vector<std::string> extensions;  ///< ascending
  std::vector<EyePicture> eyes;         ///< two
  bool opaque = false;                  ///< the picture can hide the real world
  bool position = false;                ///< the head's position is tracked, not only its direction
  bool eye_gaze = false;                ///< an eye tracker answers through XR_EXT_eye_gaze_interaction
  bool time_converts = false;           ///< the runtime's times convert to the system's clock
  /// Known only in a session; none if no session could be made, and `no_session` says why.
  struct InSession {
    std::vector<double> refresh_hz;     ///< ascending; empty: not reported
    std::optional<double> refresh_now;  ///< Hz; read only if several rates are listed
    std::vector<std::int64_t> formats;  ///< GL internal formats in the runtime's order of preference
  };
  std::optional<InSession> session;
  std::string no_session;
};

/// Connects, asks and disconnects. base::Error: no loader, no runtime, no headset, no pair of views, and
/// failed calls.
HeadsetOffer read_headset_offer();

}  // namespace study
