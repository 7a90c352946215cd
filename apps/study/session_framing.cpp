#include "apps/study/session_framing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/study/desk/viewing.hpp"
#include "libsim/bake/bake_file.hpp"
#include "libsim/methods/method.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace apps {

namespace {

/// Bakes keep a camera's angle as text: what differs by less was written otherwise.
constexpr double same_angle_deg = 0.01;

std::string degrees(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g deg", value);
  return text;
}

std::string size_words(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

bool follows_gaze(const std::string& method) { return sim::traits_of(sim::parse_method(method)).adaptive(); }

std::string departure_of(const sim::BakeHeader& bake, const FramedScene& framed, const Viewing& viewing) {
  std::vector<std::string> all;
  if (bake.camera == "overview") all.emplace_back("camera overview instead of view");
  const auto& framing = framed.framing;
  if (viewing.true_angle && std::abs(framing.camera_deg - *framing.visual_deg) > same_angle_deg)
    all.push_back("camera angle " + degrees(framing.camera_deg) + " instead of " +
                  degrees(*framing.visual_deg));
  if (follows_gaze(bake.method) && std::abs(framing.visual_scale() - 1) > 1e-3)
    all.emplace_back("levels by the camera's angle instead of the eye's");
  std::string out;
  for (const std::string& one : all) out += (out.empty() ? "" : ", ") + one;
  return out;
}

FramedScene frame_live(const sim::Scene& scene, const Viewing& viewing, PictureSize display) {
  return {{},
          scene,
          framed_view(scene.view, viewing, display.width, display.height),
          display,
          frame_picture(scene.view, viewing, display.width, display.height),
          {},
          {}};
}

/// Pictures keep the camera that they were baked with, and are scaled into the display.
FramedScene frame_pictures(const sim::Scene& scene, const sim::BakeHeader& bake, const Viewing& viewing,
                           PictureSize display) {
  const int width = bake.picture_width_px, height = bake.picture_height_px;
  const Rectangle to = fit_picture(width, height, display.width, display.height);
  const sim::Camera& camera = bake.camera == "overview" ? scene.overview : scene.view;
  FramedScene out{{}, scene, sim::make_view(camera, width, height), {to.x1 - to.x0, to.y1 - to.y0}, {},
                  {}, {}};
  out.framing.camera_deg = camera.vertical_fov_deg;
  // The display is as wide as the screen that was measured.
  if (viewing.visual_angle_deg)
    out.framing.visual_deg = viewing.visual_angle_deg(display.width, out.shown.height);
  return out;
}

FramedScene frame_bake(const std::filesystem::path& path, const Viewing& viewing, PictureSize display) {
  const sim::BakeReader reader(path);
  const sim::BakeHeader& bake = reader.header();
  const sim::Scene scene = sim::parse_scene(bake.scene_text, bake.scene_name);
  FramedScene out = bake.has_pictures() ? frame_pictures(scene, bake, viewing, display)
                                        : frame_live(scene, viewing, display);
  out.departure = departure_of(bake, out, viewing);
  return out;
}

}  // namespace

Viewing screen_viewing(std::optional<double> width_mm, std::optional<double> distance_mm, bool true_angle) {
  if (width_mm.has_value() != distance_mm.has_value())
    throw base::Error("--screen-width-mm and --viewing-distance-mm", "make an angle only together",
                      "give both, or neither");
  if (true_angle && !width_mm)
    throw base::Error("camera_angle = \"true\"", "needs to know how large the picture is seen",
                      "give --screen-width-mm and --viewing-distance-mm");
  Viewing viewing;
  viewing.true_angle = true_angle;
  if (!width_mm) return viewing;
  viewing.visual_angle_deg = [width = *width_mm, distance = *distance_mm](int width_px, int height_px) {
    return vertical_fov_deg(picture_height_mm(width, width_px, height_px), distance);
  };
  viewing.visual_angle_deg(16, 9);  // fails now if it ever does
  return viewing;
}

std::vector<FramedScene> frame_scenes(const study::Protocol& protocol, const Viewing& viewing,
                                      PictureSize display, const std::filesystem::path& bake) {
  std::vector<FramedScene> out;
  for (const study::Cell& cell : protocol.design.cells) {
    const std::string& file = cell.stimulus.scene;
    if (std::any_of(out.begin(), out.end(), [&](const auto& known) { return known.file == file; })) continue;
    FramedScene framed = bake.empty() ? frame_live(sim::read_scene(base::find_input(file)), viewing, display)
                                      : frame_bake(bake, viewing, display);
    framed.file = file;
    framed.cut = cut_off(framed.scene, framed.view);
    out.push_back(std::move(framed));
  }
  return out;
}

void check_visible(const std::vector<FramedScene>& scenes) {
  for (const FramedScene& one : scenes) {
    if (one.cut.empty()) continue;
    const auto& to = one.view.viewport;
    throw base::Error(
        one.file,
        one.cut.front() + " leaves the picture of " + size_words(to.width, to.height) +
            " px at the camera's " + degrees(one.framing.camera_deg),
        "sit nearer or make the picture larger under camera_angle = \"true\", else make it wider; "
        "vip-study check --preview shows it");
  }
}

std::vector<study::SceneFraming> framing_record(const std::vector<FramedScene>& scenes) {
  std::vector<study::SceneFraming> out;
  for (const FramedScene& one : scenes) {
    const auto& drawn = one.view.viewport;
    out.push_back({one.file, drawn.width, drawn.height, one.shown.width, one.shown.height,
                   one.framing.camera_deg, one.framing.visual_deg});
  }
  return out;
}

std::string describe_framing(const FramedScene& scene) {
  const auto& drawn = scene.view.viewport;
  std::string out = scene.scene.name + ", " + size_words(drawn.width, drawn.height) + ": camera " +
                    degrees(scene.framing.camera_deg);
  const auto ratio = scene.framing.ratio();
  if (!ratio) return out + ", angle of the eye's view not known";
  char text[32];
  std::snprintf(text, sizeof text, " (ratio %.2f)", *ratio);
  return out + ", " + degrees(*scene.framing.visual_deg) + " of the eye's view" + text;
}

std::vector<std::string> framing_notes(const study::Protocol& protocol,
                                       const std::vector<FramedScene>& scenes) {
  if (scenes.empty()) return {};
  std::vector<std::string> out;
  const auto& cells = protocol.design.cells;
  const bool follows = std::any_of(
      cells.begin(), cells.end(), [](const study::Cell& cell) { return follows_gaze(cell.stimulus.method); });
  if (follows && !scenes.front().framing.visual_deg)
    out.emplace_back(
        "eccentricity is taken in the camera's angle: how large the picture is seen is not known; "
        "--screen-width-mm and --viewing-distance-mm tell");
  for (const FramedScene& one : scenes) {
    const auto& drawn = one.view.viewport;
    if (drawn.width == one.shown.width && drawn.height == one.shown.height) continue;
    out.push_back(one.scene.name + ": baked pictures of " + size_words(drawn.width, drawn.height) +
                  " px are scaled to " + size_words(one.shown.width, one.shown.height) + " px");
  }
  return out;
}

}  // namespace apps
