#include <cmath>
#include <string>
#include <utility>

#include "libsim/bake/bake_file.hpp"
#include "libsim/bake/layout.hpp"
#include "stats/base/text.hpp"
#include "stats/base/toml.hpp"

namespace sim {

namespace {

constexpr std::size_t max_text = 4096;
constexpr std::size_t max_effects_text = 1 << 16;
constexpr std::uint32_t max_gaze_keys = 1000;

bool is_size(int width, int height) {
  const auto side = [](int px) { return px > 0 && px <= max_picture_side; };
  return (width == 0 && height == 0) || (side(width) && side(height));
}

/// The size as text, with the sizes that is_size() allows.
std::string size_words(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height) + " px; 0 x 0, or sides of 1 to " +
         std::to_string(max_picture_side) + " px are allowed";
}

bool is_angle(double degrees) { return degrees > 0 && degrees < 180; }

void put_view(ByteWriter& out, const BakedView& view) {
  out.string(view.renderer);
  out.string(view.gaze);
  out.put(static_cast<std::int32_t>(view.width_px));
  out.put(static_cast<std::int32_t>(view.height_px));
  out.put(view.camera_angle_deg);
  out.put(view.visual_angle_deg.value_or(0));
  out.put(static_cast<std::uint32_t>(view.gaze_path.size()));
  for (const GazeKey& key : view.gaze_path) {
    out.put(static_cast<std::int32_t>(key.frame));
    for (const double metres : key.point_m) out.put(metres);
  }
}

BakedView get_view(ByteReader& in) {
  BakedView view;
  view.renderer = in.string(max_text);
  view.gaze = in.string(max_text);
  view.width_px = in.get<std::int32_t>();
  view.height_px = in.get<std::int32_t>();
  view.camera_angle_deg = in.get<double>();
  if (const auto degrees = in.get<double>(); degrees != 0) view.visual_angle_deg = degrees;
  const auto keys = in.get<std::uint32_t>();
  if (keys > max_gaze_keys)
    in.fail("states " + std::to_string(keys) + " gaze keys; at most " + std::to_string(max_gaze_keys) +
            " are allowed");
  for (std::uint32_t i = 0; i < keys; ++i) {
    GazeKey& key = view.gaze_path.emplace_back();
    key.frame = in.get<std::int32_t>();
    for (double& metres : key.point_m) metres = in.get<double>();
  }
  return view;
}

void put_tolerance(ByteWriter& out, const std::optional<BakedTolerance>& tolerance) {
  out.put(static_cast<std::uint8_t>(tolerance ? 1 : 0));
  if (!tolerance) return;
  for (const double value :
       {tolerance->rate.mean, tolerance->rate.sd, tolerance->model.a, tolerance->model.b})
    out.put(value);
  out.put(tolerance->seed);
}

std::optional<BakedTolerance> get_tolerance(ByteReader& in) {
  const auto there = in.get<std::uint8_t>();
  if (there > 1)
    in.fail("has a header whose flag for a tolerance is " + std::to_string(there) + ", not 0 or 1");
  if (!there) return {};
  BakedTolerance out;
  const std::pair<double*, const char*> values[] = {{&out.rate.mean, "mean frame rate"},
                                                    {&out.rate.sd, "standard deviation of the frame rate"},
                                                    {&out.model.a, "a of the PTPE model"},
                                                    {&out.model.b, "b of the PTPE model"}};
  for (const auto& [value, name] : values) {
    *value = in.get<double>();
    if (!std::isfinite(*value)) in.fail(std::string("has a header whose ") + name + " is not finite");
  }
  out.seed = in.get<std::uint32_t>();
  return out;
}

void check(const BakedView& view, const ByteReader& in) {
  const auto within = [&](bool good, const std::string& what) {
    if (!good) in.fail("has a header whose " + what);
  };
  within(is_size(view.width_px, view.height_px),
         "size of the drawn picture is " + size_words(view.width_px, view.height_px));
  within(view.drawn() ? is_angle(view.camera_angle_deg) : view.camera_angle_deg == 0,
         "camera's angle is " + std::to_string(view.camera_angle_deg) +
             " degrees; it must lie between 0 and 180 if a picture was drawn, and be 0 otherwise");
  within(!view.visual_angle_deg || is_angle(*view.visual_angle_deg),
         "angle of the eye's view is " + std::to_string(view.visual_angle_deg.value_or(0)) +
             " degrees; it must lie between 0 and 180");
  within(
      view.surface.empty() || (view.drawn() && (view.surface == "ellipsoids" || view.surface == "spheres")),
      "surface is \"" + base::shortened(view.surface) +
          "\"; it must be empty, or ellipsoids or spheres in a bake for which a picture was drawn");
  for (const GazeKey& key : view.gaze_path) {
    const auto& p = key.point_m;
    within(key.frame >= 0 && std::isfinite(p[0] + p[1] + p[2]),
           "gaze key has frame " + std::to_string(key.frame) + " and point (" + std::to_string(p[0]) + ", " +
               std::to_string(p[1]) + ", " + std::to_string(p[2]) +
               ") m; the frame must be 0 or more, and the point finite");
  }
}

void check(const BakeHeader& header, const ByteReader& in) {
  const auto within = [&](bool good, const std::string& what) {
    if (!good) in.fail("has a header whose " + what);
  };
  const auto count = [&](std::int64_t value, std::int64_t least, std::int64_t most, const std::string& what) {
    within(value >= least && value <= most, what + " is " + std::to_string(value) + "; " +
                                                std::to_string(least) + " to " + std::to_string(most) +
                                                " are allowed");
  };
  const auto above_zero = [&](double value, const std::string& what) {
    within(std::isfinite(value) && value > 0,
           what + " is " + std::to_string(value) + "; it must be finite and above 0");
  };
  count(header.n_star, 1, max_bake_particles, "n_*");
  count(header.max_particles, 0, max_bake_particles, "largest number of particles");
  count(header.frame_count, 1, bake::max_frames, "number of frames");
  above_zero(header.frame_dt_s, "time step in s");
  for (const double side : header.tank_size_m) above_zero(side, "tank's side in m");
  for (const float radius : header.radius_by_level_m) above_zero(static_cast<double>(radius), "radius in m");
  within(is_size(header.picture_width_px, header.picture_height_px),
         "picture size is " + size_words(header.picture_width_px, header.picture_height_px));
  count(header.max_foam, 0, max_bake_foam, "number of foam particles");
  if (header.reference_k) above_zero(*header.reference_k, "reference temperature in K");
  within(header.overlay.empty() || (header.overlay == "temperature" && header.reference_k),
         "overlay is \"" + base::shortened(header.overlay) +
             "\"; it must be empty, or temperature in a bake that stores temperatures");
  check(header.view, in);
}

}  // namespace

Scene baked_scene(const BakeHeader& header) {
  Scene scene = parse_scene(header.scene_text, header.scene_name);
  const auto tables = [&](const std::string& text) {
    return base::parse_toml(text, header.scene_name + ", its effects").tables("effect");
  };
  if (header.effects) scene.effects = read_effects(tables(*header.effects));
  if (header.picture_effects) scene.picture_effects = read_picture_effects(tables(*header.picture_effects));
  return scene;
}

std::uint32_t format_of(const BakeHeader& header) {
  if (!header.view.surface.empty()) return 6;
  const bool all_of_format_4 = !header.reference_k && header.overlay.empty() && !header.picture_effects;
  return all_of_format_4 ? 4 : 5;
}

Bytes format_bake_header(const BakeHeader& header) {
  Bytes bytes;
  ByteWriter out(bytes);
  for (const std::string* text : {&header.scene_name, &header.scene_sha256, &header.method, &header.backend,
                                  &header.program_version, &header.camera}) {
    out.string(*text);
  }
  out.string(header.scene_text);
  out.put(header.n_star);
  out.put(header.max_particles);
  out.put(header.frame_count);
  out.put(header.frame_dt_s);
  for (const double side : header.tank_size_m) out.put(side);
  out.put(static_cast<std::uint32_t>(header.radius_by_level_m.size()));
  for (const float radius : header.radius_by_level_m) out.put(radius);
  out.put(static_cast<std::int32_t>(header.picture_width_px));
  out.put(static_cast<std::int32_t>(header.picture_height_px));
  put_view(out, header.view);
  put_tolerance(out, header.tolerance);
  out.put(static_cast<std::uint8_t>(header.effects ? 1 : 0));
  if (header.effects) out.string(*header.effects);
  out.put(header.max_foam);
  if (format_of(header) < 5) return bytes;
  out.put(header.reference_k.value_or(0));
  out.string(header.overlay);
  out.put(static_cast<std::uint8_t>(header.picture_effects ? 1 : 0));
  if (header.picture_effects) out.string(*header.picture_effects);
  if (format_of(header) < 6) return bytes;
  out.string(header.view.surface);
  return bytes;
}

BakeHeader parse_bake_header(ByteSpan bytes, std::uint32_t format, const std::string& place) {
  ByteReader in(bytes, place);
  BakeHeader header;
  for (std::string* text : {&header.scene_name, &header.scene_sha256, &header.method, &header.backend,
                            &header.program_version, &header.camera}) {
    *text = in.string(max_text);
  }
  header.scene_text = in.string(bake::max_scene_bytes);
  header.n_star = in.get<std::int64_t>();
  header.max_particles = in.get<std::int64_t>();
  header.frame_count = in.get<std::int64_t>();
  header.frame_dt_s = in.get<double>();
  for (double& side : header.tank_size_m) side = in.get<double>();
  const auto levels = in.get<std::uint32_t>();
  if (levels == 0 || levels > max_bake_levels)
    in.fail("states " + std::to_string(levels) + " levels; 1 to " + std::to_string(max_bake_levels) +
            " are allowed");
  for (std::uint32_t i = 0; i < levels; ++i) header.radius_by_level_m.push_back(in.get<float>());
  header.picture_width_px = in.get<std::int32_t>();
  header.picture_height_px = in.get<std::int32_t>();
  if (format >= 3) {
    header.view = get_view(in);
    header.tolerance = get_tolerance(in);
  }
  if (format >= 4) {
    const auto there = in.get<std::uint8_t>();
    if (there > 1)
      in.fail("has a header whose flag for effects is " + std::to_string(there) + ", not 0 or 1");
    if (there) header.effects = in.string(max_effects_text);
    header.max_foam = in.get<std::int64_t>();
  }
  if (format >= 5) {
    if (const auto kelvin = in.get<double>(); kelvin != 0) header.reference_k = kelvin;
    header.overlay = in.string(max_text);
    const auto there = in.get<std::uint8_t>();
    if (there > 1)
      in.fail("has a header whose flag for effects of the picture is " + std::to_string(there) +
              ", not 0 or 1");
    if (there) header.picture_effects = in.string(max_effects_text);
  }
  if (format >= 6) header.view.surface = in.string(max_text);
  if (!in.rest().empty())
    in.fail("has a header that is " + std::to_string(in.rest().size()) + " bytes too long");
  check(header, in);
  return header;
}

}  // namespace sim
