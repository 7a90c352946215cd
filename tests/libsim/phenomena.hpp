#pragma once
/// Measures phenomena that must appear in the scenes on particles: cavities, rings, crowns, dry spots,
/// ripples.

#include <array>

#include "tests/libsim/fluid_helpers.hpp"

namespace phenomena {

using fluid_test::ParticleState;

/// A 2D grid of cells, water or air.
struct Slice {
  int nx, ny;
  std::vector<char> water;
  Slice(int width, int height) : nx(width), ny(height), water(static_cast<std::size_t>(width * height), 0) {}
  char& at(int x, int y) { return water[static_cast<std::size_t>(y * nx + x)]; }

  /// Marks the cells whose centre lies within `reach` of (x, y). `edge` is the edge of a cell.
  void mark(double x, double y, double edge, double reach) {
    const auto cell = [&](double u) { return static_cast<int>(std::floor(u / edge - 0.5)); };
    for (int cy = std::max(0, cell(y - reach)); cy <= std::min(ny - 1, cell(y + reach) + 1); ++cy) {
      for (int cx = std::max(0, cell(x - reach)); cx <= std::min(nx - 1, cell(x + reach) + 1); ++cx) {
        if (std::hypot((cx + 0.5) * edge - x, (cy + 0.5) * edge - y) < reach) at(cx, cy) = 1;
      }
    }
  }
};

/// Fills the air connected to (x, y) with water and returns its number of cells.
inline int fill_air(Slice& slice, int x, int y) {
  std::vector<std::pair<int, int>> open{{x, y}};
  int cells = 0;
  while (!open.empty()) {
    const auto [cx, cy] = open.back();
    open.pop_back();
    if (cx < 0 || cy < 0 || cx >= slice.nx || cy >= slice.ny || slice.at(cx, cy)) continue;
    slice.at(cx, cy) = 1;
    ++cells;
    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
      open.emplace_back(cx + dx, cy + dy);
  }
  return cells;
}

/// Number of cells of the largest pocket of air not connected to the open top. The top row must be air.
inline int largest_cavity(Slice slice) {
  for (int x = 0; x < slice.nx; ++x) fill_air(slice, x, slice.ny - 1);
  int largest = 0;
  for (int y = 0; y < slice.ny; ++y) {
    for (int x = 0; x < slice.nx; ++x) largest = std::max(largest, fill_air(slice, x, y));
  }
  return largest;
}

/// Water seen along z, in slices as thick as a cell's edge or the particles' spacing, whichever is larger. A
/// cell holds water if a particle of its slice lies within 0.9 spacings of its centre, seen along z. (In a
/// cubic lattice every point lies within 0.87 spacings of a lattice point.)
inline std::vector<Slice> water_slices(const std::vector<ParticleState>& state, const sim::Vec3d& size,
                                       double edge, double spacing) {
  double top = size[1];
  for (const auto& p : state) top = std::max(top, static_cast<double>(p.y_m));
  const auto cells = [&](double length) { return static_cast<int>(std::ceil(length / edge)); };
  const double thickness = std::max(edge, spacing);
  const int count = std::max(1, static_cast<int>(std::ceil(size[2] / thickness - 1e-9)));
  std::vector<Slice> out(static_cast<std::size_t>(count), Slice(cells(size[0]), cells(top) + 3));
  for (const auto& p : state) {
    const int z = std::clamp(static_cast<int>(static_cast<double>(p.z_m) / thickness), 0, count - 1);
    out[static_cast<std::size_t>(z)].mark(static_cast<double>(p.x_m), static_cast<double>(p.y_m), edge,
                                          0.9 * spacing);
  }
  return out;
}

/// Fraction of the z slices with a cavity of at least `cells` cells. `edge` is the edge of a cell.
inline double share_with_cavity(const std::vector<ParticleState>& state, const sim::Vec3d& size, double edge,
                                double spacing, int cells) {
  const auto slices = water_slices(state, size, edge, spacing);
  const auto hollow = std::count_if(slices.begin(), slices.end(),
                                    [&](const Slice& slice) { return largest_cavity(slice) >= cells; });
  return static_cast<double>(hollow) / static_cast<double>(slices.size());
}

/// A vertical axis through (x, z).
struct Axis {
  double x = 0, z = 0;
  double radius(const ParticleState& p) const {
    return std::hypot(static_cast<double>(p.x_m) - x, static_cast<double>(p.z_m) - z);
  }
};

/// A vortex ring around an axis.
struct Ring {
  double circulation_m2_s = 0;  ///< positive in the direction in which a downward jet rolls up
  double core_r_m = 0;          ///< position of the strongest swirl
  double core_y_m = 0;
};

/// Flow in the half plane (r, y), averaged around an axis in square cells.
class Meridian {
 public:
  Meridian(const std::vector<ParticleState>& state, Axis axis, double r_max, double y_max, double cell)
      : cell_(cell), nr_(static_cast<int>(r_max / cell)), ny_(static_cast<int>(y_max / cell)) {
    cells_.resize(static_cast<std::size_t>(nr_ * ny_));
    for (const auto& p : state) {
      const double r = axis.radius(p);
      const int i = static_cast<int>(r / cell);
      const int j = static_cast<int>(static_cast<double>(p.y_m) / cell);
      if (i >= nr_ || j < 0 || j >= ny_ || r <= 0) continue;
      auto& sum = cells_[static_cast<std::size_t>(j * nr_ + i)];
      // Weighted by 1 / r, so that a ring of water counts by its cross-section.
      sum.weight += 1 / r;
      sum.out += ((static_cast<double>(p.x_m) - axis.x) * static_cast<double>(p.vx_m_s) +
                  (static_cast<double>(p.z_m) - axis.z) * static_cast<double>(p.vz_m_s)) /
                 (r * r);
      sum.up += static_cast<double>(p.vy_m_s) / r;
    }
  }

  /// 2 pi R times the mean speed along the circle of radius R around (r, y), over the cells that it meets.
  double circulation(double r, double y, double radius) const {
    double weights = 0;
    double along = 0;
    for (int j = 0; j < ny_; ++j) {
      for (int i = 0; i < nr_; ++i) {
        const double dr = (i + 0.5) * cell_ - r;
        const double dy = (j + 0.5) * cell_ - y;
        const double distance = std::hypot(dr, dy);
        if (std::abs(distance - radius) > cell_) continue;
        const auto& sum = cells_[static_cast<std::size_t>(j * nr_ + i)];
        weights += sum.weight;
        along += (sum.up * dr - sum.out * dy) / distance;
      }
    }
    return weights > 0 ? 2 * 3.14159265358979 * radius * along / weights : 0;
  }

  /// Mean sine of the angle between the direction to a cell and its velocity, over the cells within `reach`
  /// of (r, y): 1 at the centre of a pure swirl (Graftieaux, Michard and Grosjean 2001, Gamma_1).
  double swirl(double r, double y, double reach) const {
    int cells = 0;
    double sines = 0;
    for (int j = 0; j < ny_; ++j) {
      for (int i = 0; i < nr_; ++i) {
        const double dr = (i + 0.5) * cell_ - r;
        const double dy = (j + 0.5) * cell_ - y;
        const double distance = std::hypot(dr, dy);
        if (distance > reach || distance <= 0) continue;
        ++cells;
        const auto& sum = cells_[static_cast<std::size_t>(j * nr_ + i)];
        const double speed = std::hypot(sum.out, sum.up);
        if (speed > 0) sines += (sum.up * dr - sum.out * dy) / (distance * speed);
      }
    }
    return cells ? sines / cells : 0;
  }

  /// Largest circulation along a circle of this radius that lies within the grid, and the centre of the
  /// strongest swirl of this reach.
  Ring ring(double radius) const {
    Ring out;
    double most = 0;
    for (double y = radius; y <= ny_ * cell_ - radius; y += cell_ / 2) {
      for (double r = radius; r <= nr_ * cell_ - radius; r += cell_ / 2) {
        out.circulation_m2_s = std::max(out.circulation_m2_s, circulation(r, y, radius));
        const double here = swirl(r, y, radius);
        if (here <= most) continue;
        most = here;
        out.core_r_m = r;
        out.core_y_m = y;
      }
    }
    return out;
  }

 private:
  struct Cell {
    double weight = 0, out = 0, up = 0;
  };
  double cell_;
  int nr_, ny_;
  std::vector<Cell> cells_;
};

/// Height of the water over rings of `width` around the axis, m: the particles' volume over the area.
inline std::vector<double> ring_depths(const std::vector<ParticleState>& state, Axis axis, double r_max,
                                       double width, double spacing) {
  std::vector<double> out(static_cast<std::size_t>(r_max / width), 0.0);
  for (const auto& p : state) {
    const auto ring = static_cast<std::size_t>(axis.radius(p) / width);
    if (ring < out.size()) out[ring] += spacing * spacing * spacing;
  }
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double inner = static_cast<double>(k) * width;
    out[k] /= 3.14159265358979 * ((inner + width) * (inner + width) - inner * inner);
  }
  return out;
}

/// Depth over the disc r < radius, m.
inline double disc_depth(const std::vector<ParticleState>& state, Axis axis, double radius, double spacing) {
  return ring_depths(state, axis, radius, radius, spacing)[0];
}

}  // namespace phenomena
