/// docs/scenes.md against the keys that the readers of scenes ask for.

#include "libsim/scene/reference.hpp"

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "libsim/scene/scene.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/common/asked_keys.hpp"
#include "tests/common/needs_effects.hpp"

namespace {

namespace fs = std::filesystem;

const fs::path sources = fs::path(VIP_TEST_DIR) / "..";

/// The keys and tables that every scene text of this test has.
const char* const frame_of_a_scene = R"(format = 2
name = "Whole"
gravity_m_s2 = 9.81
checkpoints = [1]
[tank]
size_m = [8.0, 4.0, 4.0]
origin_m = [0.0, 0.0, 0.0]
lid = true
[water]
min_m = [0.0, 0.0, 0.0]
max_m = [8.0, 0.5, 4.0]
gate = false
settle_frames = 0
viscosity_m2_s = 0.01
[time]
frames_per_s = 60.0
v_ref_m_s = 5.0
min_substeps = 2
iterations = 4
courant = 0.5
[view]
eye_m = [4.0, 2.0, 9.0]
target_m = [4.0, 1.0, 2.0]
vertical_fov_deg = 50.0
near_m = 0.1
[overview]
eye_m = [4.0, 2.0, 19.0]
target_m = [4.0, 1.0, 2.0]
vertical_fov_deg = 50.0
near_m = 0.1
[[gaze]]
frame = 0
point_m = [4.0, 1.0, 2.0]
[light]
environment = "room"
seed = 7
absorption_per_m = [0.4, 0.2, 0.1]
shadow = false
[[visible]]
name = "all"
min_m = [0.0, 0.0, 0.0]
max_m = [8.0, 1.0, 4.0]
[[outlet]]
wall = "x_low"
min_m = [0.0, 1.0]
max_m = [1.0, 2.0]
)";

/// A scene with all keys that do not exclude each other.
const std::string whole_scene = std::string(frame_of_a_scene) + R"([[nozzle]]
diameter_m = 0.5
position_m = [4.0, 3.0, 2.0]
speed_m_s = 2.0
on_frames = 10
off_frames = 10
temperature_k = 300.0
[recirculation]
corner_m = 1.0
[[warm]]
min_m = [0.0, 0.0, 0.0]
max_m = [1.0, 1.0, 1.0]
temperature_k = 300.0
[[obstacle]]
shape = "capsule"
radius_m = 0.1
length_m = 0.5
centre_m = [1.0, 1.0, 1.0]
motion = "turns"
about_m = [1.0, 1.0, 1.0]
axis = [0.0, 1.0, 0.0]
rate_rad_s = 1.0
[[obstacle]]
shape = "box"
size_m = [0.2, 0.2, 0.2]
centre_m = [2.0, 1.0, 1.0]
rotation_deg = 10.0
rotation_axis = [0.0, 1.0, 0.0]
motion = "swings"
way_m = [0.1, 0.0, 0.0]
period_s = 2.0
[[obstacle]]
shape = "mesh"
file = "../meshes/ring.obj"
scale = 0.5
spacing_m = 0.02
centre_m = [6.0, 2.0, 2.0]
motion = "free"
density_kg_m3 = 500.0
friction = 0.5
[[effect]]
kind = "heat"
diffusivity_m2_s = 0.001
[[effect]]
kind = "shadows"
strength = 1.0
)";

const std::string mesh_in_the_text =
    std::regex_replace(std::regex_replace(std::regex_replace(frame_of_a_scene, std::regex("m_s2 = 9.81"),
                                                             "m_s2 = [9, 9, 9]"),
                                          std::regex(R"(\[water\]\n.*\n.*\n)"), "[water]\n"),
                       std::regex("settle_frames = 0"), "settle_s = 0.5") +
    R"([[water.block]]
min_m = [0.0, 0.0, 0.0]
max_m = [8.0, 0.5, 4.0]
[[water.block]]
min_m = [3.0, 2.0, 1.0]
max_m = [4.0, 3.0, 2.0]
[[obstacle]]
shape = "mesh"
centre_m = [2.0, 1.0, 1.0]
obj = '''
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
'''
[central_force]
omega_per_s = 1.0
centre_m = [4.0, 2.0, 2.0]
axis = [0.0, 0.0, 1.0]
)";

std::vector<std::string> scene_texts() {
  std::vector<std::string> out{whole_scene, mesh_in_the_text};
  std::vector<fs::path> files{sources / "data/truth/lobovsky_2014.toml"};
  for (const char* folder : {"data/scenes", "tests/fuzz/corpus/scene"})
    for (const auto& entry : fs::directory_iterator(sources / folder)) files.push_back(entry.path());
  for (const auto& file : files)
    if (file.extension() == ".toml") out.push_back(base::read_file(file, 1 << 20));
  return out;
}

/// The error of reading a scene; empty if there is none.
std::string reading(const std::string& text, test::AskedKeys* asked = nullptr) {
  try {
    const auto root = base::parse_toml(text, "scene.toml");
    const auto collect = [&] {
      if (!asked) return;
      // A tank whose origin is not 0 shifts the ranges of positions, so that they are not compared.
      const bool elsewhere = text.find("origin_m") != std::string::npos && text != whole_scene;
      for (auto [name, how] : root.asked()) {
        if (elsewhere && name != "tank.origin_m") how.range.reset();
        (*asked)[name].push_back(how);
      }
    };
    try {
      sim::read_scene_table(root, sources / "data/scenes");
      collect();
    } catch (const base::Error&) {  // the corpus also holds files that are refused
      collect();
      throw;
    }
  } catch (const base::Error& error) {
    return error.what();
  }
  return "";
}

/// The keys that a table [[effect]] of each kind is asked for, as "effect.foam.lifetime_s".
test::AskedKeys effect_keys() {
  test::AskedKeys out;
  const auto take = [&](const std::string& word, const std::string& key) {
    const auto root = base::parse_toml("[[effect]]\nkind = \"" + word + "\"\n" + key + " = 0.0\n", "e.toml");
    const auto tables = root.tables("effect");
    sim::read_effects(tables);
    sim::read_picture_effects(tables);
    for (const auto& [name, how] : root.asked()) {
      const bool kind = name == "effect" || name == "effect.kind";
      out[kind ? name : "effect." + word + name.substr(name.find('.'))].push_back(how);
    }
  };
  for (std::size_t k = 0; k < sim::effect_count; ++k) {
    const auto& traits = sim::traits_of(static_cast<sim::EffectKind>(k));
    take(traits.word, traits.key);
  }
  for (const auto& word : sim::picture_effect_words()) take(word, "strength");
  return out;
}

/// All keys that are asked for when all scenes of the source tree are read.
const test::AskedKeys& asked_keys() {
  static const auto asked = [] {
    test::AskedKeys all, out = effect_keys();
    for (const auto& text : scene_texts()) reading(text, &all);
    std::set<std::string> last_parts;
    for (const auto& [name, how] : out) last_parts.insert(name.substr(name.rfind('.') + 1));
    for (const auto& [name, how] : all) {
      if (name.starts_with("effect.")) {
        EXPECT_TRUE(last_parts.contains(name.substr(name.rfind('.') + 1))) << name;
      } else {
        out[name] = how;
      }
    }
    return out;
  }();
  return asked;
}

TEST(SceneReference, NamesExactlyTheKeysThatReadersAskFor) {
  NEEDS_EFFECTS;
  test::expect_names_exactly(sim::scene_reference(), asked_keys());
}

TEST(SceneReference, HasTheTypesRangesAndDefaultsOfTheReaders) {
  NEEDS_EFFECTS;
  test::expect_types_ranges_and_defaults(sim::scene_reference(), asked_keys());
}

/// The text without all lines of this key, or without all tables of this name.
std::string without(const std::string& text, const base::KeyReference& key) {
  std::string out, table, kind;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('['))
      table = line.substr(line.find_last_of('[') + 1, line.find(']') - line.find_last_of('[') - 1);
    if (line.starts_with("kind = \"")) kind = line.substr(8, line.size() - 9);
    const bool of_effect = table == "effect" && key.table == "effect." + kind;
    const bool is_key = (table == key.table || of_effect) && line.starts_with(key.key + " =");
    const bool in_table = key.table.empty() && (table + ".").starts_with(key.key + ".");
    if (!is_key && !in_table) out += line + "\n";
  }
  return out;
}

TEST(SceneReference, SaysOfEachKeyWhetherItIsNeeded) {
  NEEDS_EFFECTS;
  ASSERT_EQ(reading(whole_scene), "");
  ASSERT_EQ(reading(mesh_in_the_text), "");
  for (const auto& key : sim::scene_reference()) {
    if (key.fallback == base::where_needed) continue;
    for (const std::string& text : {whole_scene, mesh_in_the_text}) {
      const std::string less = without(text, key);
      if (less == text) continue;
      const bool missing = reading(less).find(key.key + "' is missing") != std::string::npos;
      EXPECT_EQ(missing, key.fallback.empty()) << test::name_of(key) << ": " << reading(less);
    }
  }
}

TEST(SceneReference, HasAUnitForEachNumberButTheseRatiosAndCounts) {
  const std::set<std::string> plain{"format",       "min_substeps",    "iterations",     "courant",
                                    "axis",         "rotation_axis",   "scale",          "friction",
                                    "stick",        "cg_steps",        "strength",       "coarsest_level",
                                    "crest_weight", "saliency_weight", "most_particles", "seed"};
  for (const auto& key : sim::scene_reference())
    EXPECT_EQ(key.unit.empty(), plain.contains(key.key) || key.type.find("number") == std::string::npos)
        << test::name_of(key) << " " << key.unit;
}

TEST(SceneReference, PageIsTheOneInDocs) {
  EXPECT_EQ(base::read_file(sources / "docs/scenes.md", 1 << 20), sim::scene_reference_page())
      << "write it anew: vip-view --reference > docs/scenes.md";
}

}  // namespace
