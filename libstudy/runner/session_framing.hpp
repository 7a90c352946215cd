#pragma once
/// How a display frames the scenes of a protocol: stored by a session, reported by `vip-study check`.

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

/// One scene on a display: its live fluid and baked particles, or the pictures of bakes. A scene has several
/// entries if its cells differ in renderer, size or angle.
struct FramedScene {
  std::string file;         ///< as the protocol names it
  std::vector<int> cells;   ///< cells framed like this: indices into Design::cells
  std::string renderer;     ///< that draws it or drew the pictures; empty: not known
  std::vector<int> copied;  ///< of these, the cells whose pictures come from a bake
  sim::Scene scene;
  sim::View view;           ///< of the drawn picture
  base::PictureSize shown;  ///< the picture on the display
  Framing framing;
  std::vector<std::string> cut;  ///< required visible parts that leave the picture, even partly
  /// How a bake departs from the protocol's and the display's framing; empty: not at all, or no bake.
  std::string departure;
};

/// The visual angle of a picture of this width at this distance. base::Error if only one is given, one is out
/// of range, or true_angle has neither.
Viewing screen_viewing(std::optional<double> width_mm, std::optional<double> distance_mm, bool true_angle);

/// The scenes of a protocol in the order of its cells, shown live or from `bakes`; renderer: the display's.
/// base::Error for files that cannot be read.
std::vector<FramedScene> frame_scenes(const Protocol& protocol, const Viewing& viewing,
                                      base::PictureSize display, const SessionBakes& bakes = {},
                                      const std::string& renderer = {});

/// Differences between compared pictures of a scene, such as "data/scenes/faucet.toml: size 640x360 and
/// 1280x720"; empty: none.
std::string mixed_pictures(const std::vector<FramedScene>& scenes);

/// base::Error naming mixed_pictures(), unless there are none or the protocol accepts them.
void check_one_picture(const Protocol& protocol, const std::vector<FramedScene>& scenes);

/// base::Error naming the first scene with a required part outside the picture.
void check_visible(const std::vector<FramedScene>& scenes);

/// The framing for the session's record.
std::vector<SceneFraming> framing_record(const std::vector<FramedScene>& scenes);

/// "Faucet, 1920x1080: camera 75 deg, 27.4 deg of the eye's view (ratio 0.37)".
std::string describe_framing(const FramedScene& scene);

/// Notes for the experimenter before the first participant, one line each: unknown angles although a method
/// follows the gaze, and scaled pictures.
std::vector<std::string> framing_notes(const Protocol& protocol, const std::vector<FramedScene>& scenes);

}  // namespace study
