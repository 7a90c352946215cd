#include "libsim/scene/reference.hpp"

#include <array>
#include <string_view>
#include <utility>

#include "libsim/scene/effects.hpp"
#include "libsim/scene/picture_effects.hpp"
#include "stats/base/text.hpp"
#include "stats/base/toml.hpp"

namespace sim {

namespace {

using base::KeyReference;
using base::where_needed;

// Range of a position, relative to tank.origin_m.
constexpr const char* anywhere = "[-10000, 10000] from `tank.origin_m`";
constexpr const char* least_corner = "corner with the smallest x, y and z";
constexpr const char* largest_corner = "opposite corner, at least 0.001 m further along each axis";

/// The unit in a key's name.
std::string unit_of(std::string_view key) {
  static constexpr std::array<std::pair<std::string_view, const char*>, 18> suffixes{{
      {"_m2_s", "m2/s"},
      {"_m_s2", "m/s2"},
      {"_kg_m3", "kg/m3"},
      {"_j_kg", "J/kg"},
      {"_rad_s", "rad/s"},
      {"_n_m", "N/m"},
      {"frames_per_s", "frames/s"},
      {"_per_s", "1/s"},
      {"_per_m", "1/m"},
      {"_per_k", "1/K"},
      {"_m_s", "m/s"},
      {"_deg", "degrees"},
      {"_k", "K"},
      {"_s", "s"},
      {"_m", "m"},
      {"_frames", "frames"},
      {"frame", "frames"},
      {"checkpoints", "frames"},
  }};
  for (const auto& [suffix, unit] : suffixes)
    if (key.ends_with(suffix)) return unit;
  return "";
}

const std::vector<base::TableReference>& scene_tables() {
  static const std::vector<base::TableReference> tables = [] {
    std::vector<base::TableReference> out{
        {"", "The file itself", "Stands before the first table."},
        {"tank", "[tank]", "Glass walls and a floor, free slip. Open at the top, or closed by a lid."},
        {"water", "[water]",
         R"(One block of water by `min_m` and `max_m`, or several by `[[water.block]]`. The volume of all and
n_* make the spacing d of the finest particles: d^3 = volume / (8 n_*). Water inside obstacles is left
out.)"},
        {"water.block", "[[water.block]]",
         R"(A block of several, at most 16, such as a drop above a pool or two columns. They come after the
keys of `[water]`. Blocks may touch and do not overlap. Each has the particles of its share of the volume,
rounded by largest remainders.)"},
        {"time", "[time]",
         R"(A frame takes max(min_substeps, v_ref dt / (0.5 h)) substeps or more, with dt = 1 / frames_per_s
and h = 2 d, the support of the finest particles. More follow the fastest particle, the forces and the
effects.)"},
        {"view", "[view]",
         "The participant's camera, upright. The [gaze](#gaze) is where this person looks."},
        {"overview", "[overview]", "A second camera, for figures. A scene needs none."},
        {"gaze", "[[gaze]]",
         "From its frame on the gaze stays on a point, to which it jumps within 2 frames. Without any it\nis "
         "`view.target_m`."},
        {"visible", "[[visible]]", "A box that must stay in the participant's picture."},
        {"nozzle", "[[nozzle]]",
         R"(Pours along -y in pulses, the first at frame 0. The mouth lies within the tank and at least half a
diameter away from walls and obstacles, and speed_m_s / frames_per_s below a lid. It pours as much water as it
takes from the columns of [recirculation](#recirculation), so that a closed tank gets no fuller.)"},
        {"recirculation", "[recirculation]",
         "Where nozzles take their water: what lies lowest along gravity in four columns along y in the "
         "tank's "
         "corners."},
        {"outlet", "[[outlet]]",
         R"(A rectangle in a wall, at most 4. Water that passes it leaves at the end of that frame. It is
closed while the water settles.)"},
        {"central_force", "[central_force]", "A pull to an axis that grows with the distance from it."},
        {"obstacle", "[[obstacle]]",
         R"(A rigid body, at most 16; format 2 ([methods.md](methods.md#obstacles)). It stands still while the
water settles. It must be as thick as the coarsest particles that the run may hold are apart: d in HiRes,
2 d in LoRes and with four levels.)"},
        {"light", "[light]",
         R"(What lights the scene in pictures ([methods.md](methods.md#surroundings-and-light)). The water does
not know of it.)"},
        {"warm", "[[warm]]",
         "A box whose water begins at another temperature; of boxes that overlap the later counts. Needs the "
         "effect\nheat."},
        {"effect", "[[effect]]",
         "Beside what the method does; format 2, each kind once ([methods.md](methods.md#effects)). Further "
         "keys\ndepend on `kind`."}};
    const auto kind = [&](const std::string& word) {
      out.push_back({"effect." + word, "[[effect]] with kind = \"" + word + "\"", ""});
      return out.size() - 1;
    };
    for (std::size_t k = 0; k < effect_count; ++k) {
      const EffectTraits& traits = traits_of(static_cast<EffectKind>(k));
      const std::size_t at = kind(traits.word);
      out[at].text =
          std::string("After ") + traits.source + "." +
          (traits.needs == no_effect ? "" : std::string(" Needs ") + traits_of(traits.needs).word + ".");
    }
    for (std::size_t k = 0; k < picture_effect_count; ++k) {
      const PictureEffectTraits& traits = traits_of(static_cast<PictureEffectKind>(k));
      const std::size_t at = kind(traits.word);
      out[at].text = std::string("Of the picture alone: ") + traits.source + ".";
    }
    return out;
  }();
  return tables;
}

/// In the order of EffectKind.
constexpr std::array<const char*, effect_count> coefficient_meanings{
    "kinematic viscosity beside the water's; implicit, so that honey needs no short substeps",
    "surface tension, by forces between pairs of any size",
    "work of adhesion to walls and obstacles: cos of the contact angle = work / tension - 1 (Young and "
    "Dupre)",
    "rate k at which resting air brakes a lone drop: it falls at g / k at last; water inside is not braked",
    "speed c of vorticity confinement: water that turns at omega is pushed round its core at c omega, so "
    "that "
    "swirl outlives the method's own viscosity",
    "c of the stress rho c u by which walls and obstacles brake what slides along them at u: a sheet of "
    "depth "
    "H stops after u H / c",
    "thermal diffusivity of water that conducts heat and rises where it is warm",
    "volume of spray, foam and bubbles that water makes per second and per volume at full potential"};

constexpr const char* coarsest_that_acts = "the coarsest level of water that takes part, whole";
constexpr const char* same_span = "how much more makes it full";

/// In the order of EffectOption.
constexpr std::array<const char*, option_count> option_meanings{
    "steps of conjugate gradients, whole; 0: as many as converge, 16 to 200, more where nu dt / d^2 is "
    "large. "
    "Too few let thick fluid sink too fast and still keep the momentum",
    "1: walls and obstacles hold the fluid; 0: they let it slip; between: a share",
    coarsest_that_acts,
    "the coarsest level of water that takes part, whole; adhesion takes this too",
    coarsest_that_acts,
    "slower swirl is left alone, at twice this it is fed in full",
    "swirl up to half of this is fed in full, from this on not at all",
    "how much swirl draws the eye ([methods.md](methods.md#vortices-draw-the-eye))",
    coarsest_that_acts,
    coarsest_that_acts,
    "lighter by this share per kelvin; 0: nothing rises. Times the widest difference of temperatures at most "
    "0.5",
    "of all water that nothing else is said of",
    "of walls, floor and lid; 0: they insulate",
    coarsest_that_acts,
    "trapped air: speed at which water of neighbouring cells meets over its distance, at which the potential "
    "begins",
    same_span,
    "the same for the curvature of crests",
    same_span,
    "the surface of a full crest makes as much as full trapped air in a layer of so many cells",
    "edge of the cells; 0 is a sixth of the edge of a cube that holds the water at first. At least 1.5 "
    "spacings of the coarsest particles, and wide enough that 2^20 cells fill the tank",
    "the same for v^2 / 2, which multiplies both",
    same_span,
    "mean time on the surface; each particle has half of it to one and a half",
    "of a particle of foam",
    "rate at which air brakes spray",
    "speed of bubbles against the water in Earth's gravity",
    "room in the pool, whole",
    "the coarsest level of water that makes foam, whole"};

static_assert(coefficient_meanings.back() && option_meanings.back(), "a row for each in effects.hpp");

void add_effects(std::vector<KeyReference>& keys) {
  std::string kinds;
  for (std::size_t k = 0; k < effect_count; ++k)
    kinds += base::toml_quoted(traits_of(static_cast<EffectKind>(k)).word) + ", ";
  for (std::size_t k = 0; k < picture_effect_count; ++k)
    kinds += (k ? ", " : "") + base::toml_quoted(traits_of(static_cast<PictureEffectKind>(k)).word);
  keys.push_back({"effect", "kind", "text", kinds, "", "which one"});
  for (std::size_t k = 0; k < effect_count; ++k) {
    const auto kind = static_cast<EffectKind>(k);
    const std::string table = std::string("effect.") + traits_of(kind).word;
    keys.push_back({table, traits_of(kind).key, "number", base::range_text({0, largest_coefficient}), "",
                    std::string(coefficient_meanings[k]) + "; 0 drops the effect"});
    for (std::size_t o = 0; o < option_count; ++o) {
      const OptionTraits& option = traits_of(static_cast<EffectOption>(o));
      if (option.of != kind) continue;
      keys.push_back({table, option.key, "number", base::range_text({option.least, option.most}),
                      base::shortest(option.usual), option_meanings[o]});
    }
  }
  for (std::size_t k = 0; k < picture_effect_count; ++k)
    keys.push_back({std::string("effect.") + traits_of(static_cast<PictureEffectKind>(k)).word, "strength",
                    "number", "[0, 1]", "1", "share of its full strength; 0 drops the effect"});
}

std::vector<KeyReference> all_keys() {
  std::vector<KeyReference> out{
      {"", "format", "whole number", "1, 2", "", "2 has obstacles and effects"},
      {"", "name", "text", "", "", "1 to 64 bytes"},
      {"", "gravity_m_s2", "number or list of numbers", "[0, 1000] or [-1000, 1000], its length at most 1000",
       "",
       "a number: along -y; a list: along x, y, z. Without `tank.lid` the second entry is negative, or all "
       "are 0"},
      {"", "checkpoints", "list of numbers", "[0, 1000000]", "",
       "frames from which `vip-bench table1` starts its comparisons"},
      {"", "tank", "table", "", "", "walls, floor and lid"},
      {"", "water", "table", "", "", "at the start"},
      {"", "time", "table", "", "", "frames and substeps"},
      {"", "view", "table", "", "", "the participant's camera"},
      {"", "overview", "table", "", "the view's, from three times the distance", "the camera of figures"},
      {"", "gaze", "tables", "", "none", "where the participant looks, ascending by frame"},
      {"", "visible", "tables", "", "none", "what must stay in the picture"},
      {"", "nozzle", "tables", "", "none", "what pours"},
      {"", "recirculation", "table", "", where_needed, "needed with a nozzle, refused without"},
      {"", "outlet", "tables", "", "none", "holes in the walls"},
      {"", "central_force", "table", "", "none", "in addition to gravity"},
      {"", "obstacle", "tables", "", "none", "rigid bodies; format 2"},
      {"", "light", "table", "", "its keys' defaults", "surroundings, colour of water, shadow on the floor"},
      {"", "warm", "tables", "", "none", "water of other temperatures"},
      {"", "effect", "tables", "", "none", "what the scene has beside the method; format 2"},

      {"tank", "size_m", "list of numbers", "[0.01, 10000]", "",
       "inner size along x, y, z; without a lid y is the drawn height of the walls"},
      {"tank", "lid", "true or false", "", "false",
       "a wall at the top too; water, obstacles and nozzles lie below it"},
      {"tank", "origin_m", "list of numbers", "[-1000000, 1000000]", "[0, 0, 0]",
       "the tank's low corner in the file's world, x, y, z"},

      {"water", "min_m", "list of numbers", anywhere, where_needed,
       "needed without `block`, refused with it: the block's low corner, x, y, z, inside the tank"},
      {"water", "max_m", "list of numbers", anywhere, where_needed,
       "as min_m: opposite corner, at least 0.001 m further along each axis"},
      {"water", "block", "tables", "", where_needed, "in place of min_m and max_m: several blocks"},
      {"water", "gate", "true or false", "", "",
       "walls enclose the block until it has settled; refused with several blocks"},
      {"water", "settle_s", "number", "[0, 10000]", where_needed,
       "needed, or `settle_frames`: settling before frame 0, at most 10000 frames at `time.frames_per_s`, "
       "rounded up; each multiplies the velocity by 0.9. Water that hangs in the air falls while it settles"},
      {"water", "settle_frames", "whole number", "[0, 10000]", where_needed,
       "in place of `settle_s`: the frames themselves"},
      {"water", "viscosity_m2_s", "number", "[0, 1000]", "0.05 h sqrt(g h), h = 4 d",
       "kinematic viscosity, explicit; keeps small particles from jittering. In a substep of dt at most "
       "d^2 / (11 dt) of it acts, with d the spacing of the particles: `--explain` says so. Thick fluid "
       "needs the "
       "effect viscosity"},

      {"water.block", "min_m", "list of numbers", anywhere, "", "low corner, x, y, z, inside the tank"},
      {"water.block", "max_m", "list of numbers", anywhere, "", largest_corner},

      {"time", "frames_per_s", "number", "[1, 10000]", "", "frames a second of fluid time"},
      {"time", "v_ref_m_s", "number", "[0, 1000]", "",
       "speed from which substeps follow; nozzles, and obstacles on ways of their own, are no faster"},
      {"time", "min_substeps", "whole number", "[1, 64]", "", "in each frame"},
      {"time", "iterations", "whole number", "[1, 64]", "", "constraint projections in each substep"},
      {"time", "courant", "number", "[0.05, 4]", "0.5",
       "furthest way of the fastest particle in a substep, as a share of h"},
  };
  for (const char* table : {"view", "overview"}) {
    out.push_back({table, "eye_m", "list of numbers", anywhere, "", "where the camera is, x, y, z"});
    out.push_back({table, "target_m", "list of numbers", anywhere, "",
                   "where it looks, x, y, z; not straight above or below the eye"});
    out.push_back({table, "vertical_fov_deg", "number", "[1, 170]", "", "field of view from bottom to top"});
    out.push_back({table, "near_m", "number", "[0.001, 10]", "", "what is nearer is not drawn"});
  }
  const std::vector<KeyReference> more{
      {"gaze", "frame", "whole number", "[0, 1000000]", "", "after that of the key before it"},
      {"gaze", "point_m", "list of numbers", anywhere, "", "x, y, z"},

      {"visible", "name", "text", "", "", "1 to 64 bytes"},
      {"visible", "min_m", "list of numbers", anywhere, "", least_corner},
      {"visible", "max_m", "list of numbers", anywhere, "", largest_corner},

      {"nozzle", "diameter_m", "number", "[0.001, 10000]", "", "of the round mouth"},
      {"nozzle", "position_m", "list of numbers", anywhere, "", "middle of the mouth, x, y, z"},
      {"nozzle", "speed_m_s", "number", "[0.01, 1000]", "", "of the water; at most `time.v_ref_m_s`"},
      {"nozzle", "on_frames", "whole number", "[1, 1000000]", "", "length of a pulse"},
      {"nozzle", "off_frames", "whole number", "[0, 1000000]", "", "pause after each pulse"},
      {"nozzle", "temperature_k", "number", "[1, 10000]", "`reference_k` of heat",
       "of its water; needs the effect heat"},

      {"recirculation", "corner_m", "number", "[0.01, 10000]", "",
       "edge of the columns; at most half of the tank's width"},

      {"outlet", "wall", "text", R"("x_low", "x_high", "z_low", "z_high", "y_low", "y_high")", "",
       "the wall, the floor (y_low) or the lid (y_high)"},
      {"outlet", "min_m", "list of numbers", "within the wall", "",
       "low corner along the wall's two axes, such as y and z of x_low"},
      {"outlet", "max_m", "list of numbers", "within the wall", "",
       "high corner, at least 0.001 m further along each"},

      {"central_force", "omega_per_s", "number", "[0.001, 1000]", "",
       "the pull is omega^2 times the distance from the axis"},
      {"central_force", "centre_m", "list of numbers", anywhere, "", "a point of the axis, x, y, z"},
      {"central_force", "axis", "list of numbers", "[-1000, 1000]", "", "its direction, of any length"},

      {"obstacle", "shape", "text", R"("sphere", "box", "capsule", "mesh")", "",
       "mesh: a closed surface of triangles"},
      {"obstacle", "radius_m", "number", "[0.001, 10000]", where_needed, "needed by sphere and capsule"},
      {"obstacle", "length_m", "number", "[0.001, 10000]", where_needed,
       "needed by capsule: of its axis, along y, between the middles of its round ends"},
      {"obstacle", "size_m", "list of numbers", "[0.001, 10000]", where_needed,
       "needed by box: along its own x, y, z"},
      {"obstacle", "file", "text", "", where_needed,
       "needed by mesh, or `obj`: an OBJ file, its path from the scene's folder, on a line of its own"},
      {"obstacle", "obj", "text", "", where_needed,
       "mesh: in place of `file` the same lines in the text, `obj = '''...'''`"},
      {"obstacle", "scale", "number", "[1e-06, 1000000]", "1", "mesh: metres of its unit"},
      {"obstacle", "spacing_m", "number", "[0.0001, 10000]",
       "a 48th of the longest side, or a quarter of the shortest",
       "mesh: of the grid that holds its distances"},
      {"obstacle", "centre_m", "list of numbers", anywhere, "",
       "centre of mass at the start, x, y, z; the obstacle lies within the tank or stands out at an "
       "open top"},
      {"obstacle", "rotation_deg", "number", "[-360, 360]", "not turned", "at the start, right-handed"},
      {"obstacle", "rotation_axis", "list of numbers", "[-1000, 1000]", where_needed,
       "needed by rotation_deg, refused without: a direction of any length"},
      {"obstacle", "motion", "text", R"("fixed", "turns", "swings", "free")", "\"fixed\"",
       "once the water has settled. turns: about an axis. swings: back and forth. free: moved by the water "
       "and "
       "gravity"},
      {"obstacle", "about_m", "list of numbers", anywhere, where_needed,
       "needed by turns: a point of the axis, x, y, z"},
      {"obstacle", "axis", "list of numbers", "[-1000, 1000]", where_needed,
       "needed by turns: its direction, of any length"},
      {"obstacle", "rate_rad_s", "number", "[-1000, 1000]", where_needed,
       "needed by turns: right-handed about the axis"},
      {"obstacle", "way_m", "list of numbers", "[-10000, 10000]", where_needed,
       "needed by swings: from the middle to its far end, x, y, z"},
      {"obstacle", "period_s", "number", "[0.001, 1000000]", where_needed,
       "needed by swings, which begin in the middle, towards the far end"},
      {"obstacle", "density_kg_m3", "number", "[50, 100000]", where_needed,
       "needed by free: the same in all of it"},
      {"obstacle", "friction", "number", "[0, 10]", "0",
       "Coulomb's coefficient of its surface against free obstacles, or of a free one's"},

      {"light", "environment", "text", R"("sky", "room")", "\"sky\"",
       "what surrounds the tank. sky: sun, clouds and paved ground up to the horizon. room: a hall with "
       "windows "
       "and lamps"},
      {"light", "seed", "whole number", "[0, 1000000]", "0",
       "places clouds, windows and lamps; the same seed gives the same surroundings"},
      {"light", "absorption_per_m", "list of numbers", "[0, 100]", "[0.45, 0.14, 0.1]",
       "by water, of red, green and blue light: e^(-absorption x path) is left"},
      {"light", "shadow", "true or false", "", "true",
       "flying water, obstacles and nozzles' pipes cast a shadow on the floor, also without the effect "
       "shadows"},

      {"warm", "min_m", "list of numbers", anywhere, "", least_corner},
      {"warm", "max_m", "list of numbers", anywhere, "", largest_corner},
      {"warm", "temperature_k", "number", "[1, 10000]", "", "of its water at frame 0"},
  };
  out.insert(out.end(), more.begin(), more.end());
  add_effects(out);
  for (auto& key : out) key.unit = unit_of(key.key);
  return out;
}

}  // namespace

const std::vector<KeyReference>& scene_reference() {
  static const std::vector<KeyReference> keys = all_keys();
  return keys;
}

std::string scene_reference_page() {
  return R"(# Scene files

Written by `vip-view --reference`; `vip-view FILE` shows a scene. Files are TOML, in SI units; y points up. An
unknown key, a wrong type, a value out of range and keys that contradict each other are errors at line and
column. Every byte of a file, and the triangles of its meshes, enter the SHA-256 that is stored with the data.
[methods.md](methods.md) says what effects and obstacles do; `data/scenes` holds examples.
)" + base::reference_sections(scene_tables(), scene_reference());
}

}  // namespace sim
