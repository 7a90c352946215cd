#pragma once
/// The contents of a scene file, such as tank, water, time step, views and gaze. SI units; y points up in
/// pictures. docs/scenes.md lists every key of the file.

#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libsim/scene/central_force.hpp"
#include "libsim/scene/effects.hpp"
#include "libsim/scene/heat.hpp"
#include "libsim/scene/light.hpp"
#include "libsim/scene/nozzle.hpp"
#include "libsim/scene/obstacle.hpp"
#include "libsim/scene/picture_effects.hpp"

namespace sim {

using Vec3d = std::array<double, 3>;

/// The acceleration that acts on all water and free bodies, m/s2.
struct Gravity {
  Vec3d along{0, -9.81, 0};
  Gravity() = default;
  /// Gravity of this size along -y.
  Gravity(double down) : along{0, -down, 0} {}
  Gravity(double x, double y, double z) : along{x, y, z} {}
  double size() const { return std::hypot(along[0], along[1], along[2]); }
  /// Unit vector opposite to gravity; +y without gravity.
  Vec3d up() const;
};

/// A pinhole camera. Right-handed, looking from eye to target with +y up.
struct Camera {
  Vec3d eye_m{0, 1, 3};
  Vec3d target_m{0, 0, 0};
  double vertical_fov_deg = 75;
  double near_m = 0.1;
  double far_m = 200;
};

/// At `frame` the gaze starts to move from the last key's point to `point_m`. It reaches `point_m` after
/// gaze_jump_frames frames and stays there until the next key. Up to the first key's frame
/// the gaze rests on that key's point.
struct GazeKey {
  int frame = 0;
  Vec3d point_m{};
};

/// A box that must stay in the participant's picture; each side at least 1 mm.
struct VisibleBox {
  std::string name;  ///< 1 to 64 bytes, such as "the falling jet"
  Vec3d min_m{}, max_m{};
};

// The walls of a tank, and holes in them.

/// In order of inward normals: +x, -x, +z, -z, +y, -y. A tank without a lid is open at the top.
enum class Wall { LowX, HighX, LowZ, HighZ, Floor, Lid };
inline constexpr std::size_t wall_count = 6;

std::array<double, 3> inward_normal(Wall wall);
/// The two axes along which a wall extends, ascending: 0 = x, 1 = y, 2 = z.
std::array<std::size_t, 2> axes_of(Wall wall);
/// The names of the walls in scene files, in the order of Wall.
const std::vector<std::string>& wall_names();

/// A rectangle in which a wall is open. Water that passes the wall's plane in the rectangle leaves the
/// simulation at the end of that frame. Outlets are closed while the water settles.
struct Outlet {
  Wall wall = Wall::Floor;
  std::array<double, 2> min_m{}, max_m{};  ///< corners along axes_of(wall); each side at least 1 mm
};

inline constexpr std::size_t most_outlets = 4;

/// A box that is filled with water before frame 0.
struct WaterBlock {
  Vec3d min_m{}, max_m{};
};
inline constexpr std::size_t most_water_blocks = 16;

struct Scene {
  std::string name;
  /// The tank's low corner in the file's world. All positions in this struct, and all that a simulation takes
  /// and returns, are relative to that corner, so that floats are equally precise for a distant tank; world
  /// position = origin_m + position.
  Vec3d origin_m{};
  /// Inner size of the tank; glass walls and floor. Without a lid it is open at the top: y is then the drawn
  /// height of the walls and the limit for nozzles and outlets, but the walls confine water at any height.
  Vec3d tank_size_m{};
  bool lid = false;
  std::vector<WaterBlock> water{WaterBlock{}};  ///< 1 to most_water_blocks that do not overlap
  Gravity gravity_m_s2;
  std::optional<CentralForce> central_force;   ///< in addition to gravity
  std::vector<Effect> effects;                 ///< each kind once; includes dropped effects (coefficient 0)
  std::vector<PictureEffect> picture_effects;  ///< each kind once; the solver ignores them
  SceneLight light;                            ///< of pictures; the solver ignores it
  std::vector<WarmBox> warm;                   ///< only with the effect heat
  double frame_dt_s = 1.0 / 60;
  /// Reference speed for the number of substeps (substeps_of in libsim/scene/fill.hpp).
  double v_ref_m_s = 0;
  /// True: walls enclose the water until it has settled; only in scenes with a single block of water.
  bool gate = false;
  int settle_frames = 0;
  int solver_iterations = 4;
  int min_substeps = 2;
  /// Maximum distance of the fastest particle per substep, as a share of the support h of the finest
  /// particles.
  double courant = 0.5;
  /// Kinematic viscosity of the water; < 0 = from the particles' size (viscosity_of in
  /// libsim/scene/fill.hpp).
  double viscosity_m2_s = -1;
  std::vector<int> checkpoints;
  std::vector<GazeKey> gaze;
  std::vector<VisibleBox> visible;
  std::vector<Nozzle> nozzles;
  std::vector<Outlet> outlets;      ///< at most most_outlets
  std::vector<Obstacle> obstacles;  ///< at most most_obstacles; initial water inside them is removed
  /// Edge of the four corner columns from which nozzles take the lowest water; 0 without nozzles.
  double recirculation_corner_m = 0;
  Camera view;         ///< the participant's
  Camera overview;     ///< for figures
  std::string sha256;  ///< of the file's text, or of scene_text() if it names mesh files

  /// The tank's inner size; y is infinite without a lid.
  Vec3d room_m() const;
};

/// Height above the lid at which a nozzle's water of one frame would begin, m; 0 or less if it begins below
/// the lid. A frame's water begins above the mouth by the distance that it moves in the frame.
double beyond_lid_m(const Scene& scene, const Nozzle& nozzle, double frame_dt_s);
inline constexpr const char* nozzle_at_lid =
    "is so close to the lid that the water of a frame would begin above it";

/// Reads a scene of format 1 or of format 2, which adds [[effect]] and [[obstacle]]. Errors are base::Error
/// at file:line:column, for example an unknown key, a wrong type, a value out of range, water outside the
/// tank, or an effect without the effect that it needs. beside: the folder to which mesh files are relative,
/// if the text has one.
Scene parse_scene(std::string_view text, const std::string& name,
                  const std::optional<std::filesystem::path>& beside = {});
/// Reads a scene from a parsed file; Scene::sha256 stays empty.
Scene read_scene_table(const base::TomlTable& root, const std::optional<std::filesystem::path>& beside = {});
Scene read_scene(const std::filesystem::path& path);
/// The file's text in self-contained form, including the triangles of its meshes. Scene::sha256 is its hash.
std::string scene_text(const std::filesystem::path& path);

}  // namespace sim
