#include "libsim/scene/obj_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "libsim/scene/vector.hpp"
#include "stats/base/text.hpp"

namespace sim {

namespace {

constexpr double farthest = 1e6;
/// Minimum area of a triangle divided by the square of its longest edge.
constexpr double flattest = 1e-9;

/// The words of a line, without its comment.
std::vector<std::string_view> words_of(std::string_view line) {
  line = line.substr(0, line.find('#'));
  std::vector<std::string_view> out;
  for (;;) {
    const auto begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return out;
    line.remove_prefix(begin);
    const auto end = std::min(line.find_first_of(" \t\r"), line.size());
    out.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

template <class Number>
std::optional<Number> read_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  return base::parse_number<Number>(word);
}

class Reader {
 public:
  explicit Reader(const ObjFailure& fail) : fail_(fail) {}

  void line(std::string_view text) {
    ++line_;
    const auto words = words_of(text);
    if (words.empty()) return;
    if (words[0] == "v") place(words);
    if (words[0] == "f") polygon(words);
  }
  Triangles finish() {
    if (mesh_.faces.empty()) fail_(0, "has no face", "write its surface as lines f a b c");
    check_edges();
    if (!(enclosed_volume(mesh_) > 0))
      fail_(0, "looks inwards: the volume that it encloses is not positive", "flip all of its faces");
    leave_out_loose_places();
    return std::move(mesh_);
  }

 private:
  void place(const std::vector<std::string_view>& words) {
    Vector at{};
    if (words.size() < 4) fail_(line_, "has a vertex with fewer than three coordinates", "write v x y z");
    for (std::size_t k = 0; k < 3; ++k) {
      const auto number = read_number<double>(words[k + 1]);
      if (!number)
        fail_(line_, "has '" + base::shortened(words[k + 1], 40) + "' where a number is expected",
              "write v x y z");
      at[k] = *number;
      if (!(std::abs(at[k]) <= farthest))
        fail_(line_, "has the coordinate " + base::shortest(at[k]) + " of a vertex, which is not -1e6 to 1e6",
              "use smaller numbers; the key scale multiplies them afterwards");
    }
    mesh_.places.push_back(at);
  }
  void polygon(const std::vector<std::string_view>& words) {
    std::vector<int> corners;
    for (std::size_t k = 1; k < words.size(); ++k) corners.push_back(corner(words[k]));
    if (corners.size() < 3) fail_(line_, "has a face with fewer than three corners", "write f a b c");
    for (std::size_t k = 2; k < corners.size(); ++k) triangle({corners[0], corners[k - 1], corners[k]});
  }
  int corner(std::string_view word) {
    const std::string_view number = word.substr(0, word.find('/'));
    const auto count = static_cast<std::int64_t>(mesh_.places.size());
    const auto read = read_number<std::int64_t>(number);
    if (!read)
      fail_(line_, "has '" + base::shortened(word, 40) + "' where the number of a vertex is expected",
            "write f a b c");
    const std::int64_t index = *read, from_first = index < 0 ? count + index : index - 1;
    if (index == 0 || from_first < 0 || from_first >= count)
      fail_(line_, "names vertex " + std::to_string(index) + " of " + std::to_string(count),
            "vertices count from 1, and each must come before the faces that use it");
    return static_cast<int>(from_first);
  }
  void triangle(const std::array<int, 3>& face) {
    const auto at = [&](std::size_t k) { return mesh_.places[static_cast<std::size_t>(face[k])]; };
    const Vector a = minus(at(1), at(0)), b = minus(at(2), at(1)), c = minus(at(0), at(2));
    const double longest = std::max({dot(a, a), dot(b, b), dot(c, c)});
    const Vector normal = cross(a, b);
    if (!(std::sqrt(dot(normal, normal)) / 2 > flattest * longest))
      fail_(line_, "has a face, or a triangle of its fan, without area",
            "remove it, or cut the polygon into triangles of some area");
    if (mesh_.faces.size() == most_triangles)
      fail_(line_, "is one triangle too many",
            "use at most " + std::to_string(most_triangles) + " triangles");
    mesh_.faces.push_back(face);
    lines_.push_back(line_);
  }
  /// Every edge must occur twice, once in each direction.
  void check_edges() const {
    std::map<std::array<int, 2>, int> line_of;
    for (std::size_t f = 0; f < mesh_.faces.size(); ++f) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::array<int, 2> edge{mesh_.faces[f][k], mesh_.faces[f][(k + 1) % 3]};
        if (!line_of.emplace(edge, lines_[f]).second)
          fail_(lines_[f], edge_text(edge) + " is used twice in the same direction",
                "orient all faces counter-clockwise as seen from outside, with two faces at each edge");
      }
    }
    for (const auto& [edge, line] : line_of) {
      if (!line_of.contains({edge[1], edge[0]}))
        fail_(line, edge_text(edge) + " has a face on one side only",
              "close the surface; corners at the same point must use the same vertex (merge by distance)");
    }
  }
  void leave_out_loose_places() {
    std::vector<int> number(mesh_.places.size(), -1);
    for (const auto& face : mesh_.faces) {
      for (const int corner : face) number[static_cast<std::size_t>(corner)] = 0;
    }
    std::size_t kept = 0;
    for (std::size_t k = 0; k < number.size(); ++k) {
      if (number[k] < 0) continue;
      number[k] = static_cast<int>(kept);
      mesh_.places[kept++] = mesh_.places[k];
    }
    mesh_.places.resize(kept);
    for (auto& face : mesh_.faces) {
      for (int& corner : face) corner = number[static_cast<std::size_t>(corner)];
    }
  }
  std::string edge_text(const std::array<int, 2>& edge) const {
    return "has a hole or a seam: the edge from vertex " + std::to_string(edge[0] + 1) + " to " +
           std::to_string(edge[1] + 1);
  }

  const ObjFailure& fail_;
  int line_ = 0;
  Triangles mesh_;
  std::vector<int> lines_;  ///< line of each face in the text
};

}  // namespace

Triangles read_obj(std::string_view text, const ObjFailure& fail) {
  Reader reader(fail);
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    reader.line(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return reader.finish();
}

std::string obj_of(const Triangles& mesh) {
  std::string out;
  for (const Vector& at : mesh.places)
    out += "v " + base::shortest(at[0]) + " " + base::shortest(at[1]) + " " + base::shortest(at[2]) + "\n";
  for (const auto& face : mesh.faces)
    out += "f " + std::to_string(face[0] + 1) + " " + std::to_string(face[1] + 1) + " " +
           std::to_string(face[2] + 1) + "\n";
  return out;
}

double enclosed_volume(const Triangles& mesh) {
  if (mesh.faces.empty()) return 0;
  // Relative to a vertex of the surface: far from the origin the sum would lose precision.
  const Vector from = mesh.places[static_cast<std::size_t>(mesh.faces[0][0])];
  double sum = 0;
  for (const auto& face : mesh.faces) {
    const auto at = [&](std::size_t k) {
      return minus(mesh.places[static_cast<std::size_t>(face[k])], from);
    };
    sum += dot(at(0), cross(at(1), at(2)));
  }
  return sum / 6;
}

}  // namespace sim
