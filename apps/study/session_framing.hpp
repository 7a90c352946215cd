#pragma once
/// How a display frames the scenes of a protocol: what a session stores, what `vip-study check` tells.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/framing.hpp"
#include "apps/common/picture_size.hpp"
#include "apps/study/bakes/session_bakes.hpp"
#include "libsim/scene/scene.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/store.hpp"

namespace apps {

/// One scene on a display: its live fluid and baked particles, or the pictures of bakes. A scene stands here
/// more than once where its cells differ in renderer, size or angle.
struct FramedScene {
  std::string file;         ///< as the protocol names it
  std::vector<int> cells;   ///< that show it so: indices into Design::cells
  std::string renderer;     ///< what draws it, or drew the pictures; empty: not known
  std::vector<int> copied;  ///< those of them whose pictures are a bake's
  sim::Scene scene;
  sim::View view;     ///< of the picture as it is drawn
  PictureSize shown;  ///< the picture on the display
  Framing framing;
  std::vector<std::string> cut;  ///< what must stay visible and leaves the picture, were it only in part
  /// In what a bake departs from the protocol's and the display's framing; empty: in nothing, or no bake.
  std::string departure;
};

/// The angle of a picture of this width at this distance. base::Error when one is given without the other, is
/// out of range, or when true_angle has neither.
Viewing screen_viewing(std::optional<double> width_mm, std::optional<double> distance_mm, bool true_angle);

/// The scenes of a protocol in the order of its cells, as they are shown live or of `bakes`; renderer: the
/// display's. base::Error for files that cannot be read.
std::vector<FramedScene> frame_scenes(const study::Protocol& protocol, const Viewing& viewing,
                                      PictureSize display, const SessionBakes& bakes = {},
                                      const std::string& renderer = {});

/// In what the pictures of a scene differ that are compared, such as "data/scenes/faucet.toml: size 640x360
/// and 1280x720"; empty: in nothing.
std::string mixed_pictures(const std::vector<FramedScene>& scenes);

/// base::Error that names mixed_pictures(), unless the protocol accepts them.
void check_one_picture(const study::Protocol& protocol, const std::vector<FramedScene>& scenes);

/// base::Error that names the first scene of which something leaves the picture.
void check_visible(const std::vector<FramedScene>& scenes);

/// For the record.
std::vector<study::SceneFraming> framing_record(const std::vector<FramedScene>& scenes);

/// "Faucet, 1920x1080: camera 75 deg, 27.4 deg of the eye's view (ratio 0.37)".
std::string describe_framing(const FramedScene& scene);

/// What an experimenter is told before the first participant, a line each: angles that are not known though
/// a method follows the gaze, and pictures that are scaled.
std::vector<std::string> framing_notes(const study::Protocol& protocol,
                                       const std::vector<FramedScene>& scenes);

}  // namespace apps
