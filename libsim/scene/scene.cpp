#include "libsim/scene/scene.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "libsim/scene/fill.hpp"
#include "libsim/scene/mesh_reader.hpp"
#include "libsim/scene/vector.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"
#include "stats/base/toml.hpp"

namespace sim {

namespace {

constexpr int newest_format = 2;
// Largest coordinate of tank.origin_m, m: a double resolves 1e-10 m at this distance.
constexpr double farthest_origin_m = 1e6;
constexpr double hottest_k = 1e4;
constexpr double strongest_m_s2 = 1000;  ///< largest gravity
constexpr double most_settle_frames = 10'000;

Vec3d vector(const base::TomlTable& table, const char* key, base::Range range) {
  const auto v = table.numbers(key, 3, range);
  return {v[0], v[1], v[2]};
}

/// Reads gravity: a number acts along -y, a list is a vector.
Gravity read_gravity(const base::TomlTable& root) {
  constexpr const char* key = "gravity_m_s2";
  if (!root.is_list(key)) return {root.number(key, {0, strongest_m_s2})};
  const Vec3d v = vector(root, key, {-strongest_m_s2, strongest_m_s2});
  const Gravity out{v[0], v[1], v[2]};
  if (out.size() > strongest_m_s2)
    root.fail(key, "= " + base::shortest(out.size()) + " m/s2 in all is out of range",
              "use a vector of at most " + base::shortest(strongest_m_s2) + " m/s2");
  return out;
}

/// Converts a position in the file's world to one relative to the tank's low corner.
Vec3d place(const base::TomlTable& table, const char* key, const Vec3d& origin_m) {
  const auto [least, most] = std::minmax_element(origin_m.begin(), origin_m.end());
  Vec3d out = vector(table, key, {*least - farthest_m, *most + farthest_m});
  for (std::size_t k = 0; k < 3; ++k) {
    out[k] -= origin_m[k];
    if (std::abs(out[k]) > farthest_m)
      table.fail(key, "= " + base::shortest(out[k]) + " m from tank.origin_m is too far away",
                 "keep each entry within 10000 m of it");
  }
  return out;
}

Camera camera(const base::TomlTable& table, const Vec3d& origin_m) {
  Camera out;
  out.eye_m = place(table, "eye_m", origin_m);
  out.target_m = place(table, "target_m", origin_m);
  out.vertical_fov_deg = table.number("vertical_fov_deg", {1, 170});
  out.near_m = table.number("near_m", {1e-3, 10});
  const double dx = out.target_m[0] - out.eye_m[0], dz = out.target_m[2] - out.eye_m[2];
  if (std::hypot(dx, dz) < 1e-6)
    table.fail("target_m", "lies straight above or below the eye", "move it sideways");
  return out;
}

/// The camera `view`, moved away from its target to three times the distance.
Camera overview_of(const Camera& view) {
  Camera out = view;
  for (std::size_t k = 0; k < 3; ++k)
    out.eye_m[k] = view.target_m[k] + 3 * (view.eye_m[k] - view.target_m[k]);
  return out;
}

Outlet read_outlet(const base::TomlTable& table, const Scene& scene) {
  Outlet out;
  const auto& names = wall_names();
  const auto name = std::find(names.begin(), names.end(), table.choice("wall", names));
  out.wall = static_cast<Wall>(name - names.begin());
  if (out.wall == Wall::Lid && !scene.lid)
    table.fail("wall", "is the open top of the tank", "write lid = true in [tank], or name another wall");
  auto min = table.numbers("min_m", 2);
  auto max = table.numbers("max_m", 2);
  const auto axes = axes_of(out.wall);
  constexpr const char* inside = "keep the outlet within tank.size_m from tank.origin_m";
  for (std::size_t a = 0; a < 2; ++a) {
    min[a] -= scene.origin_m[axes[a]];
    max[a] -= scene.origin_m[axes[a]];
    if (min[a] < -1e-9)
      table.fail("min_m", "reaches beyond the wall by " + base::shortest(-min[a]) + " m", inside);
    if (!(max[a] - min[a] >= 1e-3))
      table.fail("max_m", "leaves the outlet no area: one side is " + base::shortest(max[a] - min[a]) + " m",
                 "make each entry at least 1 mm larger than in min_m");
    if (max[a] > scene.tank_size_m[axes[a]] + 1e-9)
      table.fail("max_m",
                 "reaches beyond the wall by " + base::shortest(max[a] - scene.tank_size_m[axes[a]]) + " m",
                 inside);
    out.min_m[a] = min[a];
    out.max_m[a] = max[a];
  }
  return out;
}

std::vector<Outlet> read_outlets(const base::TomlTable& root, const Scene& scene) {
  std::vector<Outlet> out;
  for (const auto& table : root.tables("outlet")) {
    if (out.size() == most_outlets)
      table.fail("", "is one outlet too many", "use at most " + std::to_string(most_outlets));
    out.push_back(read_outlet(table, scene));
  }
  return out;
}

int settle_frames(const base::TomlTable& table, double frame_dt_s) {
  const bool in_frames = table.has("settle_frames"), in_seconds = table.has("settle_s");
  if (in_frames && in_seconds)
    table.fail("settle_s", "is given together with settle_frames", "keep one of settle_s and settle_frames");
  if (!in_frames && !in_seconds)
    table.fail("", "has neither settle_s nor settle_frames", "give one of the two; settle_s = 0.0 is none");
  if (in_frames) return static_cast<int>(table.integer("settle_frames", {0, most_settle_frames}));
  // The tolerance covers rounding of the quotient: 0.7 s at 60 frames/s are 42 frames.
  const double frames = std::ceil(table.number("settle_s", {0, most_settle_frames}) / frame_dt_s - 1e-9);
  if (frames > most_settle_frames)
    table.fail("settle_s", "makes " + base::shortest(frames) + " frames of settling",
               "lower it: at most " + base::shortest(most_settle_frames) + " are computed");
  return static_cast<int>(frames);
}

WaterBlock read_block(const base::TomlTable& table, const Scene& scene) {
  const Vec3d room = scene.room_m();
  WaterBlock out{place(table, "min_m", scene.origin_m), place(table, "max_m", scene.origin_m)};
  for (std::size_t k = 0; k < 3; ++k) {
    if (const double side = out.max_m[k] - out.min_m[k]; !(side >= 1e-3))
      table.fail("max_m", "leaves no room for water: one side is " + base::shortest(side) + " m",
                 "make each entry at least 1 mm larger than in min_m");
    if (const bool low = out.min_m[k] < -1e-9; low || out.max_m[k] > room[k] + 1e-9)
      table.fail(low ? "min_m" : "max_m",
                 "reaches outside the tank by " +
                     base::shortest(low ? -out.min_m[k] : out.max_m[k] - room[k]) + " m",
                 "keep the block within tank.size_m from tank.origin_m");
  }
  return out;
}

/// base::Error if the last block overlaps an earlier one. The error advises to move a block along the axis of
/// the smallest overlap. Blocks that touch do not overlap.
void check_block_apart(const base::TomlTable& table, const std::vector<WaterBlock>& water) {
  const WaterBlock& last = water.back();
  for (std::size_t b = 0; b + 1 < water.size(); ++b) {
    double deep = farthest_m;
    std::size_t along = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double common =
          std::min(last.max_m[k], water[b].max_m[k]) - std::max(last.min_m[k], water[b].min_m[k]);
      if (common < deep) deep = common, along = k;
    }
    if (deep <= 1e-9) continue;
    table.fail("min_m",
               "makes block " + std::to_string(water.size()) + " of the water overlap block " +
                   std::to_string(b + 1),
               "move one of them by " + base::shortest(std::ceil(deep * 1e5) / 1e5) + " m along " +
                   std::string(1, "xyz"[along]) + ", or make them smaller");
  }
}

std::vector<WaterBlock> read_blocks(const base::TomlTable& table, const Scene& scene) {
  const auto tables = table.tables("block");
  if (tables.empty()) return {read_block(table, scene)};
  for (const char* key : {"min_m", "max_m"})
    if (table.has(key))
      table.fail(key, "is given together with [[water.block]]",
                 "write these corners as one more [[water.block]], or leave them out");
  std::vector<WaterBlock> out;
  for (const auto& block : tables) {
    if (out.size() == most_water_blocks)
      block.fail("", "is one block too many", "use at most " + std::to_string(most_water_blocks));
    out.push_back(read_block(block, scene));
    check_block_apart(block, out);
  }
  return out;
}

void read_water(const base::TomlTable& table, Scene& scene) {
  scene.water = read_blocks(table, scene);
  scene.gate = table.boolean("gate");
  if (scene.gate && scene.water.size() > 1) table.fail("gate", gate_of_several, no_gate);
  scene.settle_frames = settle_frames(table, scene.frame_dt_s);
  if (table.has("viscosity_m2_s")) scene.viscosity_m2_s = table.number("viscosity_m2_s", {0, 1e3});
}

/// base::Error unless the nozzle's mouth is within the walls, above the floor, below the walls' top and any
/// lid, and outside obstacles.
void check_place(const base::TomlTable& table, const Nozzle& nozzle, const Scene& scene) {
  const double radius = nozzle.diameter_m / 2;
  for (const std::size_t k : {0u, 2u}) {
    const double at = nozzle.position_m[k];
    if (const double out = std::max(-at, at - scene.tank_size_m[k]); out > 0)
      table.fail("position_m", "lies " + base::shortest(out) + " m outside the tank",
                 "keep the nozzle within tank.size_m from tank.origin_m");
    if (std::min(at, scene.tank_size_m[k] - at) < radius)
      table.fail("position_m", "puts a part of the mouth inside a wall",
                 "keep the centre at least " + base::shortest(radius) + " m away from the walls");
  }
  for (const Obstacle& obstacle : scene.obstacles) {
    if (signed_distance(obstacle, obstacle.start, nozzle.position_m) < radius)
      table.fail("position_m", "puts a part of the mouth inside an obstacle",
                 "keep the centre at least " + base::shortest(radius) + " m away from obstacles");
  }
  if (nozzle.position_m[1] <= 0 || nozzle.position_m[1] > scene.tank_size_m[1])
    table.fail("position_m", "lies at or below the floor, or above the tank",
               "choose a height above the floor by at most " + base::shortest(scene.tank_size_m[1]) + " m");
  if (const double beyond = beyond_lid_m(scene, nozzle, scene.frame_dt_s); beyond > 0)
    table.fail("position_m", nozzle_at_lid,
               "lower it by " + base::shortest(std::ceil(1e4 * beyond) / 1e4) + " m");
}

/// Reads temperature_k. base::Error in a scene without the effect heat, whose particles have no temperature.
double temperature(const base::TomlTable& table, const Scene& scene) {
  const double out = table.number("temperature_k", {1, hottest_k});
  if (!lists_heat(scene))
    table.fail("temperature_k", "needs the effect heat, which the scene does not list",
               "list heat as an [[effect]], or leave the temperature out");
  return out;
}

void read_nozzles(const base::TomlTable& root, Scene& scene) {
  for (const auto& table : root.tables("nozzle")) {
    Nozzle nozzle;
    nozzle.diameter_m = table.number("diameter_m", {1e-3, farthest_m});
    nozzle.position_m = place(table, "position_m", scene.origin_m);
    nozzle.speed_m_s = table.number("speed_m_s", {1e-2, 1000});
    nozzle.on_frames = static_cast<int>(table.integer("on_frames", {1, 1e6}));
    nozzle.off_frames = static_cast<int>(table.integer("off_frames", {0, 1e6}));
    if (table.has("temperature_k")) nozzle.temperature_k = temperature(table, scene);
    check_place(table, nozzle, scene);
    if (nozzle.speed_m_s > scene.v_ref_m_s)
      table.fail("speed_m_s",
                 "= " + base::shortest(nozzle.speed_m_s) + " is faster than time.v_ref_m_s = " +
                     base::shortest(scene.v_ref_m_s) + ", from which the substeps follow",
                 "raise time.v_ref_m_s to that speed, or slow the nozzle down");
    if (pours_into_another(nozzle, scene.nozzles, scene.frame_dt_s))
      table.fail("position_m",
                 "puts the mouth into the jet of an earlier nozzle, whose water begins there too",
                 "move one of them sideways");
    scene.nozzles.push_back(nozzle);
  }
  if (scene.nozzles.empty()) return;
  const auto recirculation = root.table("recirculation");
  scene.recirculation_corner_m = recirculation.number("corner_m", {1e-2, farthest_m});
  if (2 * scene.recirculation_corner_m > std::min(scene.tank_size_m[0], scene.tank_size_m[2]))
    recirculation.fail(
        "corner_m", "= " + base::shortest(scene.recirculation_corner_m) + " makes the corner columns overlap",
        "use at most half of the tank's shorter side, " +
            base::shortest(std::min(scene.tank_size_m[0], scene.tank_size_m[2]) / 2) + " m");
}

template <class Box>
void read_box(const base::TomlTable& table, const Vec3d& origin_m, Box& box) {
  box.min_m = place(table, "min_m", origin_m);
  box.max_m = place(table, "max_m", origin_m);
  for (std::size_t k = 0; k < 3; ++k) {
    if (const double side = box.max_m[k] - box.min_m[k]; !(side >= 1e-3))
      table.fail("max_m", "leaves the box empty: one side is " + base::shortest(side) + " m",
                 "make each entry at least 1 mm larger than in min_m");
  }
}

void read_warm(const base::TomlTable& root, Scene& scene) {
  for (const auto& table : root.tables("warm")) {
    WarmBox box;
    read_box(table, scene.origin_m, box);
    box.temperature_k = temperature(table, scene);
    scene.warm.push_back(box);
  }
}

/// base::Error if expansion times the widest temperature difference exceeds most_expansion. The mean
/// temperature lies between the lowest and the highest, so that this product bounds the buoyancy of all
/// water.
void check_expansion(const base::TomlTable& root, const Scene& scene) {
  if (!lists_heat(scene)) return;
  const auto& options = coefficients_of(scene.effects).options;
  const double beta = options[static_cast<std::size_t>(EffectOption::HeatExpansion)];
  const double kelvin = widest_difference_k(scene);
  if (beta * kelvin <= most_expansion) return;
  root.fail("effect",
            "heat: temperatures " + base::shortest(kelvin) +
                " K apart times expansion_per_k = " + base::shortest(beta) + " give more than " +
                base::shortest(most_expansion) + ", beyond what Boussinesq's buoyancy is meant for",
            "lower expansion_per_k, or bring the temperatures of [[warm]], [[nozzle]], wall_k and "
            "reference_k closer together");
}

std::string read_name(const base::TomlTable& table) {
  std::string out = table.string("name");
  if (out.empty() || out.size() > 64 || !base::is_plain_line(out))
    table.fail("name", "is empty or too long, or holds a control character", "use 1 to 64 bytes of one line");
  return out;
}

std::vector<VisibleBox> visible_boxes(const base::TomlTable& root, const Vec3d& origin_m) {
  std::vector<VisibleBox> out;
  for (const auto& table : root.tables("visible")) {
    out.push_back({read_name(table), {}, {}});
    read_box(table, origin_m, out.back());
  }
  return out;
}

}  // namespace

Vec3d Gravity::up() const {
  const double all = size();
  if (!(all > 0)) return {0, 1, 0};
  return {0 - along[0] / all, 0 - along[1] / all, 0 - along[2] / all};  // 0 - a: +0, not -0, for a = 0
}

Scene parse_scene(std::string_view text, const std::string& name,
                  const std::optional<std::filesystem::path>& beside) {
  Scene scene = read_scene_table(base::parse_toml(text, name), beside);
  scene.sha256 = base::sha256_hex(text);
  return scene;
}

Scene read_scene_table(const base::TomlTable& root, const std::optional<std::filesystem::path>& beside) {
  const std::int64_t format = root.integer("format");
  if (format < 1 || format > newest_format)
    root.fail("format", "= " + std::to_string(format) + " is not a format that this program reads (1 or 2)",
              "use the version of ViP-Lab for which the file was written");
  Scene scene;
  scene.name = read_name(root);
  scene.gravity_m_s2 = read_gravity(root);
  for (const double frame : root.numbers("checkpoints", 0, {0, 1e6})) {
    if (frame != std::floor(frame)) root.fail("checkpoints", "holds a fraction", "write whole frames");
    scene.checkpoints.push_back(static_cast<int>(frame));
  }
  const auto tank = root.table("tank");
  scene.tank_size_m = vector(tank, "size_m", {1e-2, farthest_m});
  scene.lid = tank.boolean_or("lid", false);
  if (!scene.lid && scene.gravity_m_s2.size() > 0 && scene.gravity_m_s2.along[1] >= 0)
    root.fail("gravity_m_s2",
              "does not point down, and the tank is open at the top: the water would leave it",
              "write lid = true in [tank], or make the second entry negative");
  if (tank.has("origin_m"))
    scene.origin_m = vector(tank, "origin_m", {-farthest_origin_m, farthest_origin_m});
  scene.central_force = read_central_force(root, scene.origin_m);
  const auto time = root.table("time");
  scene.frame_dt_s = 1 / time.number("frames_per_s", {1, 10'000});
  scene.v_ref_m_s = time.number("v_ref_m_s", {0, 1000});
  scene.min_substeps = static_cast<int>(time.integer("min_substeps", {1, 64}));
  scene.solver_iterations = static_cast<int>(time.integer("iterations", {1, 64}));
  scene.courant = time.number_or("courant", scene.courant, {0.05, 4});
  read_water(root.table("water"), scene);
  if (format < 2 && root.has("effect"))
    root.fail("format", "= 1 does not allow [[effect]], which came with format 2", "write format = 2");
  if (format < 2 && root.has("obstacle"))
    root.fail("format", "= 1 does not allow [[obstacle]], which came with format 2", "write format = 2");
  const auto effects = root.tables("effect");
  scene.effects = read_effects(effects);
  scene.picture_effects = read_picture_effects(effects);
  scene.light = read_light(root);
  read_warm(root, scene);
  scene.obstacles = read_obstacles(root, scene.room_m(), scene.origin_m, scene.v_ref_m_s, beside);
  read_nozzles(root, scene);
  check_expansion(root, scene);
  scene.outlets = read_outlets(root, scene);
  scene.view = camera(root.table("view"), scene.origin_m);
  scene.overview =
      root.has("overview") ? camera(root.table("overview"), scene.origin_m) : overview_of(scene.view);
  scene.visible = visible_boxes(root, scene.origin_m);
  for (const auto& key : root.tables("gaze")) {
    scene.gaze.push_back(
        {static_cast<int>(key.integer("frame", {0, 1e6})), place(key, "point_m", scene.origin_m)});
    const auto n = scene.gaze.size();
    if (n > 1 && scene.gaze[n - 1].frame <= scene.gaze[n - 2].frame)
      key.fail("frame",
               "= " + std::to_string(scene.gaze[n - 1].frame) + " is not above frame " +
                   std::to_string(scene.gaze[n - 2].frame) + " of the gaze key before it",
               "order the gaze keys by frame");
  }
  root.finish();
  return scene;
}

Scene read_scene(const std::filesystem::path& path) {
  const auto found = base::find_input(path);
  const std::string text = base::read_file(found, most_scene_bytes);
  Scene out = parse_scene(text, found.string(), found.parent_path());
  // The hash covers the mesh files, because a changed mesh makes a different scene.
  out.sha256 = base::sha256_hex(with_meshes(text, found));
  return out;
}

std::string scene_text(const std::filesystem::path& path) {
  const auto found = base::find_input(path);
  return with_meshes(base::read_file(found, most_scene_bytes), found);
}

}  // namespace sim
