#include "libsim/scene/mesh.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <thread>

#include "libsim/scene/vector.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"

namespace sim {

namespace {

using Matrix = std::array<Vector, 3>;
constexpr int usual_cells = 48, fewest_cells = 4;
constexpr int margin = 2;   ///< grid cells beyond the mesh on each side
constexpr int spread = 64;  ///< directions in which contacts_m() looks, in addition to the axes
constexpr unsigned most_threads = 8;

/// Diagonalises a symmetric matrix by Jacobi rotations; returns the principal axes as columns.
Matrix principal_axes(Matrix& a) {
  Matrix axes{Vector{1, 0, 0}, Vector{0, 1, 0}, Vector{0, 0, 1}};
  const double least = 1e-9 * (a[0][0] + a[1][1] + a[2][2]);
  for (int sweep = 0; sweep < 64; ++sweep) {
    std::size_t p = 0, q = 1;
    for (const auto& [i, j] : {std::pair{0, 2}, std::pair{1, 2}}) {
      const auto row = static_cast<std::size_t>(i), column = static_cast<std::size_t>(j);
      if (std::abs(a[row][column]) <= std::abs(a[p][q])) continue;
      p = row;
      q = column;
    }
    if (std::abs(a[p][q]) <= least) break;
    // Of the two rotation angles that make a[p][q] zero, the smaller one.
    const double gap = a[q][q] - a[p][p];
    const double angle = gap == 0 ? std::numbers::pi / 4 : 0.5 * std::atan(2 * a[p][q] / gap);
    const double c = std::cos(angle), s = std::sin(angle);
    const auto turn = [&](double& first, double& second) {
      const double old = first;
      first = c * old - s * second;
      second = s * old + c * second;
    };
    for (Vector& row : a) turn(row[p], row[q]);
    for (std::size_t k = 0; k < 3; ++k) turn(a[p][k], a[q][k]);
    for (Vector& row : axes) turn(row[p], row[q]);
  }
  return axes;
}

std::array<double, 4> quaternion_of(const Matrix& m) {
  const double trace = m[0][0] + m[1][1] + m[2][2];
  std::array<double, 4> out{};
  if (trace > 0) {
    const double s = 2 * std::sqrt(1 + trace);
    out = {(m[2][1] - m[1][2]) / s, (m[0][2] - m[2][0]) / s, (m[1][0] - m[0][1]) / s, s / 4};
  } else {
    std::size_t i = m[1][1] > m[0][0] ? 1 : 0;
    if (m[2][2] > m[i][i]) i = 2;
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    const double s = 2 * std::sqrt(1 + m[i][i] - m[j][j] - m[k][k]);
    out[i] = s / 4;
    out[j] = (m[j][i] + m[i][j]) / s;
    out[k] = (m[k][i] + m[i][k]) / s;
    out[3] = (m[k][j] - m[j][k]) / s;
  }
  return out;
}

/// A surface in coordinates with the origin in its centre of mass, along its principal axes.
struct Settled {
  Triangles mesh;
  double volume_m3;
  Vector inertia_m2;
  std::array<double, 4> turn;
};
Settled settled(const Triangles& mesh) {
  MassProperties mass = mass_properties(mesh);
  const Matrix axes = principal_axes(mass.inertia_m2);
  Settled out{mesh, mass.volume_m3, {}, quaternion_of(axes)};
  for (std::size_t k = 0; k < 3; ++k) out.inertia_m2[k] = mass.inertia_m2[k][k];
  for (Vector& at : out.mesh.places) {
    const Vector from = minus(at, mass.centre_m);
    for (std::size_t k = 0; k < 3; ++k)
      at[k] = from[0] * axes[0][k] + from[1] * axes[1][k] + from[2] * axes[2][k];
  }
  return out;
}

/// Computes Mesh::round_about() of a settled() surface. The integrals over a triangle are sums over the
/// midpoints of its edges, which is exact because the integrands are quadratic.
std::array<bool, 3> round_about(const Triangles& mesh) {
  // Largest mean over the surface of (r x n)_k^2 of a round body, as a share of the mean squared distance
  // from axis k; r is the position from the centre of mass, n the unit normal. A long regular prism counts as
  // round if it has at least 19 sides.
  constexpr double most = 0.01;
  Vector turning{}, from_axis{};
  for (const auto& face : mesh.faces) {
    const auto at = [&](std::size_t k) { return mesh.places[static_cast<std::size_t>(face[k % 3])]; };
    const Vector normal = cross(minus(at(1), at(0)), minus(at(2), at(0)));
    const double area = std::sqrt(dot(normal, normal));
    for (std::size_t edge = 0; edge < 3; ++edge) {
      Vector middle = at(edge);
      for (std::size_t k = 0; k < 3; ++k) middle[k] = (middle[k] + at(edge + 1)[k]) / 2;
      const Vector lever = cross(middle, normal);
      for (std::size_t k = 0; k < 3; ++k) {
        turning[k] += lever[k] * lever[k] / area;
        from_axis[k] += area * (dot(middle, middle) - middle[k] * middle[k]);
      }
    }
  }
  std::array<bool, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) out[k] = turning[k] <= most * from_axis[k];
  return out;
}

/// Computes the distances at all nodes. Threads take the rows of the grid one by one.
void bake(const SurfaceTree& tree, DistanceGrid& out) {
  // No structured binding of out.nodes, because clang 14 does not allow lambdas to capture one.
  const int nx = out.nodes[0], ny = out.nodes[1], rows = ny * out.nodes[2];
  std::atomic<int> next = 0;
  const auto work = [&] {
    for (int row = next++; row < rows; row = next++) {
      double bound = 1e30;
      for (int x = 0; x < nx; ++x) {
        const Vector at{out.low_m[0] + out.step_m * x, out.low_m[1] + out.step_m * (row % ny),
                        out.low_m[2] + out.step_m * (row / ny)};
        const double distance = tree.distance(at, bound);
        bound = 1.001 * (std::abs(distance) + out.step_m);
        out.values_m[static_cast<std::size_t>(row) * static_cast<std::size_t>(nx) +
                     static_cast<std::size_t>(x)] = static_cast<float>(distance);
      }
    }
  };
  std::vector<std::jthread> threads;
  const unsigned count = std::clamp(std::jthread::hardware_concurrency(), 1U, most_threads);
  for (unsigned k = 1; k < count; ++k) threads.emplace_back(work);
  work();
}

}  // namespace

MassProperties mass_properties(const Triangles& mesh) {
  MassProperties out;
  const Vector from = mesh.places[static_cast<std::size_t>(mesh.faces[0][0])];
  Vector first{};
  Matrix second{};
  for (const auto& face : mesh.faces) {
    std::array<Vector, 3> at;
    for (std::size_t k = 0; k < 3; ++k) at[k] = minus(mesh.places[static_cast<std::size_t>(face[k])], from);
    const double volume = dot(at[0], cross(at[1], at[2])) / 6;
    out.volume_m3 += volume;
    const Vector all{at[0][0] + at[1][0] + at[2][0], at[0][1] + at[1][1] + at[2][1],
                     at[0][2] + at[1][2] + at[2][2]};
    for (std::size_t i = 0; i < 3; ++i) {
      first[i] += volume / 4 * all[i];
      for (std::size_t j = 0; j < 3; ++j) {
        double products = all[i] * all[j];
        for (const Vector& corner : at) products += corner[i] * corner[j];
        second[i][j] += volume / 20 * products;
      }
    }
  }
  Matrix spread_m2{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      spread_m2[i][j] = second[i][j] / out.volume_m3 - first[i] * first[j] / (out.volume_m3 * out.volume_m3);
  }
  const double trace = spread_m2[0][0] + spread_m2[1][1] + spread_m2[2][2];
  for (std::size_t i = 0; i < 3; ++i) {
    out.centre_m[i] = from[i] + first[i] / out.volume_m3;
    for (std::size_t j = 0; j < 3; ++j) out.inertia_m2[i][j] = (i == j ? trace : 0) - spread_m2[i][j];
  }
  return out;
}

Mesh::Mesh(const Triangles& mesh, double spacing_m)
    : mesh_(), sha256_(base::sha256_hex(obj_of(mesh) + base::shortest(spacing_m))), tree_([&] {
        Settled body = settled(mesh);
        mesh_ = std::move(body.mesh);
        volume_m3_ = body.volume_m3;
        inertia_m2_ = body.inertia_m2;
        turn_ = body.turn;
        round_about_ = sim::round_about(mesh_);
        return SurfaceTree(mesh_);
      }()) {
  low_m_ = high_m_ = mesh_.places[static_cast<std::size_t>(mesh_.faces[0][0])];
  for (const auto& face : mesh_.faces) {
    for (const int corner : face) {
      const Vector& at = mesh_.places[static_cast<std::size_t>(corner)];
      farthest_m_ = std::max(farthest_m_, std::sqrt(dot(at, at)));
      for (std::size_t k = 0; k < 3; ++k) {
        low_m_[k] = std::min(low_m_[k], at[k]);
        high_m_[k] = std::max(high_m_[k], at[k]);
      }
    }
  }
  const Vector size = minus(high_m_, low_m_);
  const auto [shortest, longest] = std::minmax_element(size.begin(), size.end());
  spacing_m_ = spacing_m > 0 ? spacing_m : std::min(*longest / usual_cells, *shortest / fewest_cells);
}

double Mesh::nodes_along(std::size_t axis) const {
  return std::ceil((high_m_[axis] - low_m_[axis]) / spacing_m_) + 1 + 2 * margin;
}
double Mesh::grid_nodes() const { return nodes_along(0) * nodes_along(1) * nodes_along(2); }

const DistanceGrid& Mesh::grid() const {
  std::call_once(baked_, [this] {
    grid_.step_m = spacing_m_;
    for (std::size_t k = 0; k < 3; ++k) {
      grid_.nodes[k] = static_cast<int>(nodes_along(k));
      grid_.low_m[k] = (low_m_[k] + high_m_[k] - spacing_m_ * (grid_.nodes[k] - 1)) / 2;
    }
    grid_.values_m.resize(static_cast<std::size_t>(grid_nodes()));
    bake(tree_, grid_);
  });
  return grid_;
}

std::vector<Vector> Mesh::contacts_m() const {
  std::vector<Vector> ways{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (int k = 0; k < spread; ++k) {
    // Directions on Vogel's spiral over the sphere, at equal steps in height.
    const double y = 1 - (2 * k + 1.0) / spread, round = std::sqrt(1 - y * y), turn = 2.399963229728653 * k;
    ways.push_back({round * std::cos(turn), y, round * std::sin(turn)});
  }
  std::vector<Vector> out;
  for (const Vector& way : ways) {
    Vector best{};
    double most = -1e300;
    for (const auto& face : mesh_.faces) {
      for (const int corner : face) {
        const Vector& at = mesh_.places[static_cast<std::size_t>(corner)];
        if (dot(at, way) <= most) continue;
        most = dot(at, way);
        best = at;
      }
    }
    if (std::find(out.begin(), out.end(), best) == out.end()) out.push_back(best);
  }
  return out;
}

double Mesh::thickness_m() const {
  const auto& values = grid().values_m;
  return -2 * static_cast<double>(*std::min_element(values.begin(), values.end()));
}

}  // namespace sim
