#include "libsim/scene/mesh_reader.hpp"

#include <algorithm>

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
    table.fail("file", "is given together with obj", "give one of the two");
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

std::string_view after_blanks(std::string_view text) {
  return text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
}

/// The file named by a line `file = "name"` or `file = 'name'`; empty for other lines.
std::string_view file_named_by(std::string_view line) {
  constexpr std::string_view key = "file";
  line = after_blanks(line);
  if (!line.starts_with(key)) return {};
  line = after_blanks(line.substr(key.size()));
  if (!line.starts_with('=')) return {};
  line = after_blanks(line.substr(1));
  if (line.empty() || (line[0] != '"' && line[0] != '\'')) return {};
  const auto end = line.find(line[0], 1);
  if (end == std::string_view::npos) return {};
  const std::string_view name = line.substr(1, end - 1), rest = after_blanks(line.substr(end + 1));
  if (line[0] == '"' && name.find('\\') != std::string_view::npos) return {};
  return rest.empty() || rest[0] == '#' ? name : std::string_view{};
}

/// The quotes of a multi-line string that a line of TOML leaves open: three, or none. open: the quotes
/// that the previous line left open.
std::string_view left_open(std::string_view line, std::string_view open) {
  constexpr std::string_view quotes[] = {"\"\"\"", "'''", "\"", "'"};
  std::size_t k = 0;
  while (k < line.size()) {
    const std::string_view rest = line.substr(k);
    if (open.empty()) {
      if (rest[0] == '#') return {};
      const auto* const found = std::find_if(std::begin(quotes), std::end(quotes),
                                             [&](std::string_view quote) { return rest.starts_with(quote); });
      if (found != std::end(quotes)) open = *found;
      k += std::max<std::size_t>(open.size(), 1);
    } else if (open[0] == '"' && rest[0] == '\\') {
      k += 2;
    } else if (rest.starts_with(open)) {
      k += open.size();
      // Three closing quotes may be preceded by up to two that belong to the string.
      for (int more = 0; open.size() == 3 && more < 2 && k < line.size() && line[k] == open[0]; ++more) ++k;
      open = {};
    } else {
      ++k;
    }
  }
  return open.size() == 3 ? open : std::string_view{};
}

bool names_a_file(std::string_view text, const std::filesystem::path& scene_file) {
  const auto obstacles = base::parse_toml(text, scene_file.string()).tables("obstacle");
  return std::any_of(obstacles.begin(), obstacles.end(),
                     [](const base::TomlTable& table) { return table.has("file"); });
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
    table.fail("spacing_m",
               "= " + base::shortest(out->spacing_m()) + " is more than half of the mesh's shortest side, " +
                   base::shortest(shortest) + " m",
               "use at most " + base::shortest(shortest / 2) + " m");
  if (out->grid_nodes() > static_cast<double>(most_grid_nodes))
    table.fail("spacing_m", "gives the mesh a grid of " + base::shortest(out->grid_nodes()) + " nodes",
               "use a larger spacing_m: a grid has at most " + std::to_string(most_grid_nodes) + " nodes");
  return out;
}

std::string with_meshes(std::string_view text, const std::filesystem::path& scene_file) {
  if (!names_a_file(text, scene_file)) return std::string(text);
  std::string out;
  std::size_t bytes = text.size();
  std::string_view open;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size() - 1);
    const std::string_view line = text.substr(0, end + 1);
    text.remove_prefix(end + 1);
    const std::string_view name = open.empty() ? file_named_by(line) : "";
    open = left_open(line, open);
    if (name.empty()) {
      out += line;
      continue;
    }
    const auto mesh_file = scene_file.parent_path() / name;
    const std::string mesh = "obj = '''\n" + obj_of(read_file(mesh_file)) + "'''\n";
    out += mesh;
    bytes += mesh.size() - line.size();
    if (bytes > most_scene_bytes)
      throw base::Error(mesh_file.string(),
                        "takes the scene to " + std::to_string(bytes) + " bytes with its triangles",
                        "use fewer triangles: a scene has at most " + std::to_string(most_scene_bytes) +
                            " bytes, those of all its meshes included");
  }
  if (names_a_file(out, scene_file))
    throw base::Error(scene_file.string(),
                      "names the file of a mesh beside other keys, or in another notation",
                      "write file = \"...\" on a line of its own, without escapes");
  return out;
}

}  // namespace sim
