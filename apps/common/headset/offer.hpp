#pragma once
/// What a headset and its runtime offer, as far as a study cares.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// One eye's picture as the runtime recommends it, px.
struct EyePicture {
  std::uint32_t width = 0, height = 0;
  friend bool operator==(const EyePicture&, const EyePicture&) = default;
};

struct HeadsetOffer {
  std::string runtime, runtime_version;  ///< the version as the runtime counts it
  std::string headset;
  std::vector<std::string> extensions;  ///< ascending
  std::vector<EyePicture> eyes;         ///< two
  bool opaque = false;                  ///< the world can be hidden behind the picture
  bool position = false;                ///< the head's place is followed, not its direction alone
  bool eye_gaze = false;                ///< an eye tracker answers through XR_EXT_eye_gaze_interaction
  bool time_converts = false;           ///< the runtime's times are told on the system's clock
  /// What only a session knows; nothing where none could be made, then `no_session` says why.
  struct InSession {
    std::vector<double> refresh_hz;     ///< ascending; empty: the runtime does not say
    std::optional<double> refresh_now;  ///< Hz; read only where several rates are listed
    std::vector<std::int64_t> formats;  ///< GL internal formats in the runtime's order of preference
  };
  std::optional<InSession> session;
  std::string no_session;
};

/// Connects, asks and leaves. base::Error: no loader, no runtime, no headset, no pair of views, and calls
/// that fail.
HeadsetOffer read_headset_offer();

}  // namespace apps
