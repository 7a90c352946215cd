#include "libstudy/runner/preview.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "libsim/gl/gl_context.hpp"
#include "libsim/gl/offscreen.hpp"
#include "libsim/gl/png.hpp"
#include "libsim/methods/preset.hpp"
#include "libsim/render/fluid_picture.hpp"
#include "libsim/render/temperature_scale.hpp"
#include "libsim/scene/fill.hpp"
#include "libsim/solver/settled_state.hpp"
#include "stats/base/file.hpp"
#include "stats/base/progress.hpp"

namespace study {

namespace {

constexpr std::int64_t particles = 4096;  // enough to recognise the water
using Colour = std::array<std::uint8_t, 3>;
constexpr Colour kept{0, 150, 60}, lost{220, 30, 30}, fovea{250, 170, 0};

sim::Image draw_fluid(const FramedScene& framed, bool paint_temperature) {
  sim::SimulationOptions options;
  options.method = sim::MethodKind::LoRes;
  const sim::Scene acting = sim::acting_scene(framed.scene, options.method);
  options.n_star = particles;
  options.backend = sim::choose_backend("auto");
  options.cache = sim::default_cache_folder();
  const auto fluid = sim::make_simulation(framed.scene, options);
  const int frames = framed.scene.checkpoints.empty() ? 0 : framed.scene.checkpoints.front();
  for (int frame = 0; frame < frames; ++frame) fluid->step_frame();
  sim::FluidPicture picture(acting);
  const sim::Offscreen target(framed.view.viewport.width, framed.view.viewport.height);
  picture.draw(*fluid, framed.view, target.framebuffer());
  if (const sim::TemperatureScale scale(acting); paint_temperature && scale.heat()) {
    std::vector<float> temperature_k;
    fluid->read_field(sim::ParticleField::Temperature, temperature_k);
    picture.renderer().paint(scale.overlay(temperature_k), target.framebuffer());
  }
  return target.read();
}

/// Draws a dot of 3 x 3 pixels. (x, y): its middle, px from the lower left corner.
void dot(sim::Image& image, double x, double y, const Colour& colour) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const auto column = std::lround(std::floor(x)) + dx;
      const auto row = image.height - 1 - std::lround(std::floor(y)) + dy;
      if (column < 0 || column >= image.width || row < 0 || row >= image.height) continue;
      std::copy(colour.begin(), colour.end(), image.rgba.begin() + 4 * (row * image.width + column));
    }
  }
}

/// Draws the twelve edges of a box as rows of dots. The dots touch each other unless the box is much larger
/// than the picture.
void outline(sim::Image& image, const FramedScene& framed, const sim::VisibleBox& box) {
  const auto corners = corners_of(box);
  const bool cut = std::find(framed.cut.begin(), framed.cut.end(), box.name) != framed.cut.end();
  const int dots = 2 * (image.width + image.height);
  for (std::size_t from = 0; from < 8; ++from) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (from >> axis & 1) continue;
      const std::size_t to = from | std::size_t{1} << axis;
      for (int i = 0; i <= dots; ++i) {
        sim::Vec3d at = corners[from];
        at[axis] += (corners[to][axis] - at[axis]) * i / dots;
        if (const auto place = place_in(framed.view, at))
          dot(image, place->first, place->second, cut ? lost : kept);
      }
    }
  }
}

/// Draws the rim of the fovea for a gaze at the middle. Its radius follows from the visual angle of the
/// picture, or from the camera's angle if the visual angle is unknown.
void circle(sim::Image& image, const Framing& framing) {
  constexpr double degree = std::numbers::pi / 180;
  const double angle = framing.visual_deg.value_or(framing.camera_deg);
  const double radius = 0.5 * image.height * std::tan(sim::Readings{}.fovea_half_angle_deg * degree) /
                        std::tan(0.5 * angle * degree);
  const int dots = static_cast<int>(8 * radius) + 8;
  for (int i = 0; i < dots; ++i) {
    const double turn = 2 * std::numbers::pi * i / dots;
    dot(image, 0.5 * image.width + radius * std::cos(turn), 0.5 * image.height + radius * std::sin(turn),
        fovea);
  }
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '&')
      out += "&amp;";
    else
      out += c;
  }
  return out;
}

std::string section(const FramedScene& framed, const std::string& picture) {
  std::string out =
      "<h2>" + escaped(framed.scene.name) + "</h2>\n<p>" + escaped(describe_framing(framed)) + ".";
  for (const auto& box : framed.scene.visible) {
    const bool cut = std::find(framed.cut.begin(), framed.cut.end(), box.name) != framed.cut.end();
    out += cut ? " <strong>Leaves the picture: " + escaped(box.name) + ".</strong>"
               : " Stays in the picture: " + escaped(box.name) + ".";
  }
  return out + "</p>\n<img src=\"" + picture + "\" alt=\"" + escaped(framed.scene.name) + "\">\n";
}

constexpr const char* page_head =
    "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>What participants see</title>\n"
    "<style>body{font:16px/1.5 sans-serif;max-width:1100px;margin:2em auto;padding:0 1em}"
    "img{width:100%;height:auto}strong{color:#b00}</style>\n<h1>What participants see</h1>\n"
    "<p>Each scene as the display frames it, coarse, without pages. Outlined: what must stay visible, green, "
    "or "
    "red where the picture cuts it. Circle: the fovea of a gaze on the middle.</p>\n";

}  // namespace

void write_preview(const std::filesystem::path& folder, const std::vector<FramedScene>& scenes,
                   bool paint_temperature) {
  base::make_folder(folder);
  const auto context = sim::GlContext::make_headless();
  base::Progress progress("preview", scenes.size());
  std::string page = page_head;
  std::size_t done = 0;
  for (const FramedScene& framed : scenes) {
    sim::Image image = draw_fluid(framed, paint_temperature);
    circle(image, framed.framing);
    for (const auto& box : framed.scene.visible) outline(image, framed, box);
    const std::string name = "scene_" + std::to_string(++done) + ".png";
    sim::write_png(folder / name, image);
    page += section(framed, name);
    progress.update(done);
  }
  base::write_file_atomically(folder / "index.html", page);
}

}  // namespace study
