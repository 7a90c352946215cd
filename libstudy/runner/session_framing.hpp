#pragma once
/// How a display frames the scenes of a protocol. Sessions store the framing, and `vip-study check` reports
/// it.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libsim/scene/scene.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/stimulus/bakes/session_bakes.hpp"
#include "libstudy/stimulus/framing.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/picture_size.hpp"

namespace study {

/// One scene as a display shows it: drawn from live fluid or baked particles, or copied from the pictures of
/// bakes. A scene has several entries if its cells differ in renderer, picture size or camera angle.
struct FramedScene {
  std::string file;         ///< path of the scene file as in the protocol
  std::vector<int> cells;   ///< indices of the cells with this framing in Design::cells
  std::string renderer;     ///< renderer that draws the scene or drew the bakes' pictures; empty: not known
  std::vector<int> copied;  ///< those of `cells` whose pictures come from a bake
  sim::Scene scene;
  sim::View view;           ///< camera view of the drawn picture
  base::PictureSize shown;  ///< size of the picture on the display
  Framing framing;
  std::vector<std::string> cut;  ///< parts that must stay visible, but leave the picture at least partly
  /// Differences between a bake's framing and the framing by protocol and display; empty: none, or no bake.
  std::string departure;
};

/// Viewing with the visual angle of pictures on a screen of this width at this distance; without both, the
/// visual angle is unknown. base::Error if only one of width and distance is given, if one is out of range,
/// or if true_angle (the camera uses the visual angle) is set without them.
Viewing screen_viewing(std::optional<double> width_mm, std::optional<double> distance_mm, bool true_angle);

/// The scenes of a protocol in the order of its cells, shown live or from `bakes`. renderer: name of the
/// renderer that the display uses. base::Error for files that cannot be read.
std::vector<FramedScene> frame_scenes(const Protocol& protocol, const Viewing& viewing,
                                      base::PictureSize display, const SessionBakes& bakes = {},
                                      const std::string& renderer = {});

/// Differences between pictures of the same scene, which participants compare, such as
/// "data/scenes/faucet.toml: size 640x360 and 1280x720"; empty: none.
std::string mixed_pictures(const std::vector<FramedScene>& scenes);

/// Throws a base::Error with mixed_pictures(), unless the text is empty or the protocol accepts mixed
/// pictures.
void check_one_picture(const Protocol& protocol, const std::vector<FramedScene>& scenes);

/// Throws a base::Error for the first scene in which the picture cuts off a part that must stay visible.
void check_visible(const std::vector<FramedScene>& scenes);

/// Converts framed scenes to the form that the session's record stores.
std::vector<SceneFraming> framing_record(const std::vector<FramedScene>& scenes);

/// One line such as "Faucet, 1920x1080: camera 75 deg, 27.4 deg of the eye's view (ratio 0.37)".
std::string describe_framing(const FramedScene& scene);

/// Notes for the experimenter before the first participant, one line each: differences between compared
/// pictures (mixed_pictures()), an unknown visual angle although a method follows the gaze, and baked
/// pictures that are scaled to the display.
std::vector<std::string> framing_notes(const Protocol& protocol, const std::vector<FramedScene>& scenes);

}  // namespace study
