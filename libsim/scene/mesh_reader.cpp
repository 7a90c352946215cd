#include "libsim/scene/mesh_reader.hpp"

#include <algorithm>
#include <regex>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"

namespace sim {

namespace {

constexpr std::size_t most_file_bytes = 16 << 20;

Triangles read_file(const std::filesystem::path& path) {
  const std::string text = base::read_file(path, most_file_bytes);
  return read_obj(text, [&](int line, const std::string& problem, const std::string& mend) {
    throw base::Error(path.string() + (line > 0 ? ":" + std::to_string(line) : ""), problem, mend);
  });
}

Triangles read_triangles(const base::TomlTable& table, const std::optional<std::filesystem::path>& beside) {
  if (table.has("file") && table.has("obj"))
    table.fail("file", "stands beside obj", "give the mesh as one of the two");
  if (!table.has("file")) {
    if (!table.has("obj"))
      table.fail("", "is a mesh without a file", "name an OBJ file: file = \"boat.obj\"");
    return read_obj(table.string("obj"), [&](int line, const std::string& problem, const std::string& mend) {
      table.fail("obj", (line > 0 ? "in its line " + std::to_string(line) + " " : "") + problem, mend);
    });
  }
  const std::string name = table.string("file");
  if (!base::is_plain_line(name) || name.empty())
    table.fail("file", "is not the name of a file", "name an OBJ file beside the scene's");
  if (!beside)
    table.fail("file", "names a file, but this text comes without a folder",
               "give the triangles in the text: obj = '''...'''");
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(*beside / name, ignored))
    table.fail("file", "names a file that does not exist: " + (*beside / name).string(),
               "give its path from the folder of the scene's file");
  return read_file(*beside / name);
}

}  // namespace

std::shared_ptr<const Mesh> read_mesh(const base::TomlTable& table, base::Range size_m,
                                      const std::optional<std::filesystem::path>& beside) {
  Triangles triangles = read_triangles(table, beside);
  const double scale = table.number_or("scale", 1, {1e-6, 1e6});
  for (auto& place : triangles.places) {
    for (double& x : place) x *= scale;
  }
  const double spacing_m = table.has("spacing_m") ? table.number("spacing_m", {1e-4, size_m.max}) : 0;
  auto out = std::make_shared<const Mesh>(triangles, spacing_m);
  double shortest = size_m.max;
  for (std::size_t k = 0; k < 3; ++k) {
    const double side = out->high_m()[k] - out->low_m()[k];
    shortest = std::min(shortest, side);
    if (!(side >= size_m.min && side <= size_m.max))
      table.fail(table.has("scale") ? "scale" : "shape",
                 "makes the mesh " + base::shortest(side) + " m long on one side",
                 "choose a scale so that all sides are within " + base::range_text(size_m) + " m");
  }
  if (2 * out->spacing_m() > shortest)
    table.fail("spacing_m", "is more than half of the mesh's shortest side", "make it smaller");
  if (out->grid_nodes() > static_cast<double>(most_grid_nodes))
    table.fail("spacing_m", "gives the mesh a grid of " + base::shortest(out->grid_nodes()) + " nodes",
               "use at most " + std::to_string(most_grid_nodes));
  return out;
}

std::string with_meshes(std::string_view text, const std::filesystem::path& scene_file) {
  static const std::regex names_file(R"re(\s*file\s*=\s*(?:"([^"\\]+)"|'([^']+)')\s*(?:#.*)?)re");
  if (text.find("file") == std::string_view::npos) return std::string(text);
  std::string out;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size() - 1);
    const std::string line(text.substr(0, end + 1));
    text.remove_prefix(end + 1);
    std::smatch match;
    const std::string bare = line.substr(0, line.find_last_not_of("\r\n") + 1);
    if (!std::regex_match(bare, match, names_file)) {
      out += line;
      continue;
    }
    const std::string name = match[1].matched ? match[1].str() : match[2].str();
    out += "obj = '''\n" + obj_of(read_file(scene_file.parent_path() / name)) + "'''\n";
  }
  for (const auto& table : base::parse_toml(out, scene_file.string()).tables("obstacle")) {
    if (table.has("file"))
      throw base::Error(scene_file.string(), "names the file of a mesh beside other keys",
                        "write file = \"...\" on a line of its own");
  }
  if (out.size() > most_scene_bytes)
    throw base::Error(scene_file.string(),
                      "has " + std::to_string(out.size()) + " bytes with the triangles of its meshes",
                      "use fewer triangles: at most " + std::to_string(most_scene_bytes) + " bytes");
  return out;
}

}  // namespace sim
