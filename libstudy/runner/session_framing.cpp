#include "libstudy/runner/session_framing.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <map>

#include "libsim/methods/method.hpp"
#include "libstudy/pages/viewing.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

std::string degrees(double value) { return fmt::format("{:.4g} deg", value); }

bool follows_gaze(const std::string& method) { return sim::traits_of(sim::parse_method(method)).adaptive(); }

bool differ(double a, double b) { return std::abs(a - b) > same_angle_deg; }

/// For a bake of a method that follows the gaze: a text if its particle levels were computed for another
/// visual angle of the picture than this session's. Empty if not, and for other methods.
std::string levels_departure(const sim::BakeHeader& bake, const FramedScene& framed) {
  const auto &baked = bake.view.visual_angle_deg, &seen = framed.framing.visual_deg;
  if (!follows_gaze(bake.method)) return "";
  if (!baked) {
    const bool same = std::abs(framed.framing.visual_scale() - 1) <= 1e-3;
    return same ? "" : "levels by the camera's angle instead of the eye's";
  }
  if (seen && !differ(*baked, *seen)) return "";
  return "levels by " + degrees(*baked) + " of the eye's view instead of " +
         (seen ? degrees(*seen) : "the camera's angle");
}

std::string departure_of(const sim::BakeHeader& bake, const FramedScene& framed, double wanted_deg) {
  std::vector<std::string> all;
  if (bake.camera == "overview") all.emplace_back("camera overview instead of view");
  if (differ(framed.framing.camera_deg, wanted_deg))
    all.push_back("camera angle " + degrees(framed.framing.camera_deg) + " instead of " +
                  degrees(wanted_deg));
  if (const std::string levels = levels_departure(bake, framed); !levels.empty()) all.push_back(levels);
  return base::joined(all);
}

FramedScene frame_live(const sim::Scene& scene, const Viewing& viewing, base::PictureSize display) {
  FramedScene out;
  out.scene = scene;
  out.view = framed_view(scene.view, viewing, display.width, display.height);
  out.shown = display;
  out.framing = frame_picture(scene.view, viewing, display.width, display.height);
  return out;
}

/// Framing of baked pictures: they keep the camera of the bake and are scaled to fit the display.
FramedScene frame_pictures(const sim::Scene& scene, const sim::BakeHeader& bake, const Viewing& viewing,
                           base::PictureSize display) {
  const int width = bake.picture_width_px, height = bake.picture_height_px;
  const Rectangle to = fit_picture(width, height, display.width, display.height);
  sim::Camera camera = bake.camera == "overview" ? scene.overview : scene.view;
  if (bake.view.drawn()) camera.vertical_fov_deg = bake.view.camera_angle_deg;
  FramedScene out;
  out.scene = scene;
  out.view = sim::make_view(camera, width, height);
  out.shown = {to.x1 - to.x0, to.y1 - to.y0};
  out.framing.camera_deg = camera.vertical_fov_deg;
  // The measured width belongs to the whole display, so the angle is computed from display.width and not from
  // the picture's width.
  if (viewing.visual_angle_deg)
    out.framing.visual_deg = viewing.visual_angle_deg(display.width, out.shown.height);
  out.renderer = bake.view.renderer;
  return out;
}

FramedScene frame_bake(const sim::BakeHeader& bake, const Viewing& viewing, base::PictureSize display,
                       const std::string& renderer) {
  const sim::Scene scene = sim::baked_scene(bake);
  FramedScene out = bake.has_pictures() ? frame_pictures(scene, bake, viewing, display)
                                        : frame_live(scene, viewing, display);
  if (!bake.has_pictures()) out.renderer = renderer;
  const double wanted_deg = viewing.true_angle ? *out.framing.visual_deg : scene.view.vertical_fov_deg;
  out.departure = departure_of(bake, out, wanted_deg);
  return out;
}

bool alike(const FramedScene& a, const FramedScene& b) {
  const auto &from = a.view.viewport, &to = b.view.viewport;
  return a.file == b.file && a.renderer == b.renderer && from.width == to.width && from.height == to.height &&
         !differ(a.framing.camera_deg, b.framing.camera_deg);
}

/// Describes the differences between two framings of the same scene.
std::string difference(const FramedScene& a, const FramedScene& b) {
  std::vector<std::string> all;
  const auto &one = a.view.viewport, &other = b.view.viewport;
  const auto known = [](const std::string& name) { return name.empty() ? "not known" : name; };
  if (a.renderer != b.renderer)
    all.push_back("renderer '" + known(a.renderer) + "' and '" + known(b.renderer) + "'");
  if (one.width != other.width || one.height != other.height)
    all.push_back("size " + base::size_words({one.width, one.height}) + " and " +
                  base::size_words({other.width, other.height}));
  if (differ(a.framing.camera_deg, b.framing.camera_deg))
    all.push_back("angle " + degrees(a.framing.camera_deg) + " and " + degrees(b.framing.camera_deg));
  return base::joined(all);
}

}  // namespace

Viewing screen_viewing(std::optional<double> width_mm, std::optional<double> distance_mm, bool true_angle) {
  if (width_mm.has_value() != distance_mm.has_value())
    throw base::Error("--screen-width-mm and --viewing-distance-mm",
                      "are needed together for the visual angle", "give both, or neither");
  if (true_angle && !width_mm)
    throw base::Error("camera_angle = \"true\"", "needs the visual angle of the picture",
                      "give --screen-width-mm and --viewing-distance-mm");
  Viewing viewing;
  viewing.true_angle = true_angle;
  if (!width_mm) return viewing;
  viewing.visual_angle_deg = [width = *width_mm, distance = *distance_mm](int width_px, int height_px) {
    return vertical_fov_deg(picture_height_mm(width, width_px, height_px), distance);
  };
  viewing.visual_angle_deg(16, 9);  // throws for values out of range, before any picture is framed
  return viewing;
}

std::vector<FramedScene> frame_scenes(const Protocol& protocol, const Viewing& viewing,
                                      base::PictureSize display, const SessionBakes& bakes,
                                      const std::string& renderer) {
  std::vector<FramedScene> out;
  std::map<std::string, FramedScene> live;  // live scenes by file; each file is read once
  for (std::size_t i = 0; i < protocol.design.cells.size(); ++i) {
    const Cell& cell = protocol.design.cells[i];
    const std::string& file = cell.stimulus.scene;
    const FoundBake* bake = bakes.of(cell);
    if (!bake && !live.contains(file)) {
      live[file] = frame_live(sim::read_scene(base::find_input(file)), viewing, display);
      live[file].renderer = renderer;
    }
    FramedScene framed = bake ? frame_bake(bake->header, viewing, display, renderer) : live[file];
    framed.file = file;
    auto known = std::find_if(out.begin(), out.end(), [&](const auto& one) { return alike(one, framed); });
    if (known == out.end()) {
      framed.cut = cut_off(framed.scene, framed.view);
      known = out.insert(out.end(), std::move(framed));
    } else if (known->departure.empty()) {
      known->departure = framed.departure;
    }
    known->cells.push_back(static_cast<int>(i));
    if (bake && bake->header.has_pictures()) known->copied.push_back(static_cast<int>(i));
  }
  return out;
}

std::string mixed_pictures(const std::vector<FramedScene>& scenes) {
  std::vector<std::string> all;
  for (auto one = scenes.begin(); one != scenes.end(); ++one) {
    const auto before =
        std::find_if(scenes.begin(), one, [&](const auto& had) { return had.file == one->file; });
    if (before != one) all.push_back(one->file + ": " + difference(*before, *one));
  }
  return base::joined(all);
}

void check_one_picture(const Protocol& protocol, const std::vector<FramedScene>& scenes) {
  const std::string mixed = mixed_pictures(scenes);
  if (mixed.empty() || protocol.accept_mixed_pictures) return;
  throw base::Error(
      "--stimulus", "pictures that are compared differ: " + mixed,
      "bake particles only, which the session draws (vip-study bake --protocol without --keep "
      "pictures); or bake the pictures on this station at the session's size and angle; or write "
      "accept_mixed_pictures = true in the protocol: the report then names the difference");
}

void check_visible(const std::vector<FramedScene>& scenes) {
  for (const FramedScene& one : scenes) {
    if (one.cut.empty()) continue;
    const auto& to = one.view.viewport;
    throw base::Error(
        one.file,
        one.cut.front() + " leaves the picture of " + base::size_words({to.width, to.height}) +
            " px at the camera's " + degrees(one.framing.camera_deg),
        "with camera_angle = \"true\" sit nearer or make the picture larger, otherwise make the "
        "picture wider; vip-study check --preview shows the scene");
  }
}

std::vector<SceneFraming> framing_record(const std::vector<FramedScene>& scenes) {
  std::vector<SceneFraming> out;
  for (const FramedScene& one : scenes) {
    const auto& drawn = one.view.viewport;
    out.push_back({one.file, drawn.width, drawn.height, one.shown.width, one.shown.height,
                   one.framing.camera_deg, one.framing.visual_deg, one.cells, one.copied, one.renderer});
  }
  return out;
}

std::string describe_framing(const FramedScene& scene) {
  const auto& drawn = scene.view.viewport;
  std::string out = scene.scene.name + ", " + base::size_words({drawn.width, drawn.height}) + ": camera " +
                    degrees(scene.framing.camera_deg);
  const auto ratio = scene.framing.ratio();
  if (!ratio) return out + ", angle of the eye's view not known";
  return fmt::format("{}, {} of the eye's view (ratio {:.2f})", out, degrees(*scene.framing.visual_deg),
                     *ratio);
}

std::vector<std::string> framing_notes(const Protocol& protocol, const std::vector<FramedScene>& scenes) {
  if (scenes.empty()) return {};
  std::vector<std::string> out;
  if (const std::string mixed = mixed_pictures(scenes); !mixed.empty())
    out.push_back("pictures that are compared differ, which the protocol accepts: " + mixed);
  const auto& cells = protocol.design.cells;
  const bool follows = std::any_of(cells.begin(), cells.end(),
                                   [](const Cell& cell) { return follows_gaze(cell.stimulus.method); });
  if (follows && !scenes.front().framing.visual_deg)
    out.emplace_back(
        "eccentricity is computed from the camera's angle, because the visual angle of the picture is not "
        "known; give --screen-width-mm and --viewing-distance-mm");
  for (const FramedScene& one : scenes) {
    const auto& drawn = one.view.viewport;
    if (drawn.width == one.shown.width && drawn.height == one.shown.height) continue;
    out.push_back(one.scene.name + ": baked pictures of " + base::size_words({drawn.width, drawn.height}) +
                  " px are scaled to " + base::size_words({one.shown.width, one.shown.height}) + " px");
  }
  return out;
}

}  // namespace study
