#include "libsim/activation/importance.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// share of the way to the new percentiles that the range of F_pim moves per frame
constexpr float range_share = 0.1f;

SIM_FN Vec3 difference(Vec4 high, Vec4 low, float steps) { return (1 / steps) * (xyz(high) - xyz(low)); }

/// Inputs of ViP-Fluid's Eq. 13 and 14 in one cell and level: differences of the mean velocity V between
/// cells and between levels.
struct VelocitySlopes {
  const Vec4* velocity;
  CellBlock block;
  Vec4* slope_x;
  Vec4* slope_y;
  Vec4* slope_z;
  Vec4* across_levels;

  SIM_FN void operator()(int i) const {
    const int cells = block.size();
    const int level = i / cells;
    const int cell = i % cells;
    const float known = velocity[i].w;
    slope_x[i] = with_w(along(level, cell, 1, cell % block.nx, block.nx), known);
    slope_y[i] = with_w(along(level, cell, block.nx, cell / block.nx % block.ny, block.ny), known);
    slope_z[i] =
        with_w(along(level, cell, block.nx * block.ny, cell / (block.nx * block.ny), block.nz), known);
    across_levels[i] = with_w(by_level(level, cell), known);
  }

  /// Central difference of the mean velocity V per cell; one-sided next to the border and to cells without a
  /// value.
  SIM_FN Vec3 along(int level, int cell, int stride, int at, int size) const {
    const Vec4 none{0, 0, 0, value_unknown};
    const Vec4* here = velocity + level * block.size() + cell;
    const Vec4 low = at > 0 ? here[-stride] : none;
    const Vec4 high = at + 1 < size ? here[stride] : none;
    return between(low, *here, high, 1, 1);
  }

  /// Difference of the mean velocity V per level, between the nearest finer and the nearest coarser level
  /// with particles in the cell; one-sided if only one of them exists.
  SIM_FN Vec3 by_level(int level, int cell) const {
    const int cells = block.size();
    Vec4 low{0, 0, 0, value_unknown};
    Vec4 high = low;
    float down = 1;
    float up = 1;
    for (int other = 0; other < grid_levels; ++other) {
      const Vec4 value = velocity[other * cells + cell];
      if (value.w != value_measured) continue;
      if (other < level) {
        low = value;
        down = static_cast<float>(level - other);
      }
      if (other > level && high.w == value_unknown) {
        high = value;
        up = static_cast<float>(other - level);
      }
    }
    return between(low, velocity[level * cells + cell], high, down, up);
  }

  SIM_FN static Vec3 between(Vec4 low, Vec4 here, Vec4 high, float down, float up) {
    const bool has_low = low.w != value_unknown;
    const bool has_high = high.w != value_unknown;
    if (has_low && has_high) return difference(high, low, down + up);
    if (has_high) return difference(high, here, up);
    if (has_low) return difference(here, low, down);
    return {0, 0, 0};
  }
};

/// Sum of the mean velocity V over the levels that have particles in a cell, and differences of the kinetic
/// energy E between cells.
struct CellSums {
  const Vec4* velocity;
  const float* energy;
  CellBlock block;
  Vec4* total;
  Vec4* energy_slope;

  SIM_FN void operator()(int cell) const {
    const int cells = block.size();
    Vec3 sum{0, 0, 0};
    for (int level = 0; level < grid_levels; ++level) {
      const Vec4 value = velocity[level * cells + cell];
      if (value.w == value_measured) sum += xyz(value);
    }
    total[cell] = with_w(sum, value_measured);
    energy_slope[cell] = {along(cell, 1, cell % block.nx, block.nx),
                          along(cell, block.nx, cell / block.nx % block.ny, block.ny),
                          along(cell, block.nx * block.ny, cell / (block.nx * block.ny), block.nz),
                          value_measured};
  }

  SIM_FN float along(int cell, int stride, int at, int size) const {
    const int low = at > 0 ? cell - stride : cell;
    const int high = at + 1 < size ? cell + stride : cell;
    if (low == high) return 0;
    return (energy[high] - energy[low]) * static_cast<float>(stride) / static_cast<float>(high - low);
  }
};

struct Importance {
  const Vec4* position;
  const std::uint8_t* level;
  const float* saliency;
  float* importance;
  ValueCounter counter;
  GridFrame grid;
  const Vec4* velocity;
  const float* energy;
  const Vec4* slope_x;
  const Vec4* slope_y;
  const Vec4* slope_z;
  const Vec4* across_levels;
  const Vec4* total;
  const Vec4* energy_slope;
  float speed_floor;
  bool relative_level_change;

  SIM_FN void operator()(int i) const {
    const float f = of(i);
    importance[i] = f;
    counter.add(i, f);
  }

  /// F_pim of particle i, ViP-Fluid Eq. 12; 0 if it is not finite, or if the grid has no velocity at the
  /// particle.
  SIM_FN float of(int i) const {
    const CellCorners corners = grid.corners(xyz(position[i]));
    const int offset = level[i] * grid.cells();
    const Vec4 v = sample(velocity, offset, corners);
    if (v.w == value_unknown) return 0;
    const float mass = static_cast<float>(1 << level[i]);
    const float s = saliency ? saliency[i] : 0;
    const float f = mass * expf(s) * (within(offset, corners, v) + across(offset, corners, v));
    return std::isfinite(f) ? f : 0;
  }

  /// f_in, ViP-Fluid Eq. 13: the gradient of the level's mean velocity, divided by the size of this velocity,
  /// plus the same gradient divided by the size of the sum over the levels.
  SIM_FN float within(int offset, const CellCorners& corners, Vec4 v) const {
    const Vec3 x = xyz(sample(slope_x, offset, corners));
    const Vec3 y = xyz(sample(slope_y, offset, corners));
    const Vec3 z = xyz(sample(slope_z, offset, corners));
    const float gradient = sqrtf(dot(x, x) + dot(y, y) + dot(z, z));
    const Vec3 all = xyz(sample(total, 0, corners));
    return gradient / (length(xyz(v)) + speed_floor) + gradient / (length(all) + speed_floor);
  }

  /// f_cr, ViP-Fluid Eq. 14: the difference of the mean velocity between levels, plus the relative difference
  /// of the kinetic energy between cells.
  SIM_FN float across(int offset, const CellCorners& corners, Vec4 v) const {
    float by_level = length(xyz(sample(across_levels, offset, corners)));
    if (relative_level_change) by_level /= length(xyz(v)) + speed_floor;
    float here = 0;
    for (int c = 0; c < 8; ++c) here += corners.weight[c] * energy[corners.cell[c]];
    const float slope = length(xyz(sample(energy_slope, 0, corners)));
    return by_level + slope / (here + 0.5f * speed_floor * speed_floor);
  }
};

}  // namespace

void measure_importance(Activation& activation, ImportanceView p, const float* saliency, float speed_floor) {
  auto& a = activation;
  const GridFrame grid = a.grid.frame();
  const auto cells = static_cast<std::size_t>(grid.cells());
  for (auto* column : {&a.slope_x, &a.slope_y, &a.slope_z, &a.across_levels})
    column->resize(grid_levels * cells);
  a.total.resize(cells);
  a.energy_slope.resize(cells);
  a.importance.resize(static_cast<std::size_t>(p.size()));
  for_each_pass("grid slopes",
                Pass<VelocitySlopes>{grid_levels * grid.cells(),
                                     {a.grid.velocity().data(), grid.block, a.slope_x.data(),
                                      a.slope_y.data(), a.slope_z.data(), a.across_levels.data()}},
                Pass<CellSums>{grid.cells(),
                               {a.grid.velocity().data(), a.grid.energy().data(), grid.block, a.total.data(),
                                a.energy_slope.data()}});
  for_each("importance", p.size(),
           Importance{.position = p.position(),
                      .level = p.level(),
                      .saliency = saliency,
                      .importance = a.importance.data(),
                      .counter = a.rules.robust_range ? a.range.counter() : ValueCounter{},
                      .grid = grid,
                      .velocity = a.grid.velocity().data(),
                      .energy = a.grid.energy().data(),
                      .slope_x = a.slope_x.data(),
                      .slope_y = a.slope_y.data(),
                      .slope_z = a.slope_z.data(),
                      .across_levels = a.across_levels.data(),
                      .total = a.total.data(),
                      .energy_slope = a.energy_slope.data(),
                      .speed_floor = speed_floor,
                      .relative_level_change = a.rules.relative_level_change});
  if (a.rules.robust_range) {
    a.range.follow_percentiles(p.size(), range_share);
  } else {
    a.range.take_extremes(a.importance, p.size());
  }
}

}  // namespace sim::SIM_BACKEND
