#include "libsim/saliency/gradients.hpp"

#include "libsim/neighbors/cell_key.hpp"
#include "libsim/particles/kernels.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Velocity and density of particle i as one vector (vx, vy, vz, rho / rho_0).
SIM_FN Vec4 quantities(const GradientFields& f, int i) { return with_w(xyz(f.velocity[i]), f.density[i]); }

/// Volume m_j / rho_j of a particle: d^3 with the spacing d = h / 2, divided by `density` = rho_j / rho_0.
/// The lower bound 0.1 has no effect on valid densities: an isolated particle has a fifth of the rest
/// density.
SIM_FN float volume(float h, float density) { return 0.125f * h * h * h / at_least(density, 0.1f); }

/// Gradients of velocity and density: (d/dx, d/dy, d/dz) of (vx, vy, vz, rho / rho_0).
struct Gradients {
  Vec4 axis[3]{};

  SIM_FN void add(float weight, const Gradients& other) {
    for (int a = 0; a < 3; ++a) add(weight, other.axis[a], a);
  }
  SIM_FN void add(float weight, Vec4 step, int a) {
    axis[a] = {axis[a].x + weight * step.x, axis[a].y + weight * step.y, axis[a].z + weight * step.z,
               axis[a].w + weight * step.w};
  }
  /// Adds one neighbour's term (m_j / rho_j) (q_j - q_i) grad W, with the solver's spiky gradient. `own` =
  /// q_i, `other` = q_j.
  SIM_FN void add_pair(const GradientFields& f, int i, int j, float support, Vec4 own, Vec4 other) {
    const Vec4 place = f.position[j];
    const Vec3 offset = xyz(f.position[i]) - xyz(place);
    const float r = length(offset);
    if (r >= support || r <= coincident * support) return;
    const float weight = -volume(place.w, f.density[j]) * Kernel(support).slope(r) / r;
    const Vec4 step = {other.x - own.x, other.y - own.y, other.z - own.z, other.w - own.w};
    add(weight * offset.x, step, 0);
    add(weight * offset.y, step, 1);
    add(weight * offset.z, step, 2);
  }
  template <class Team>
  SIM_FN void sum_over(Team team) {
    for (Vec4& a : axis) a = {team.sum(a.x), team.sum(a.y), team.sum(a.z), team.sum(a.w)};
  }
  /// The temporal feature before occlusion, f_T gamma_t of ViP-Fluid Eq. 6, from these gradients.
  SIM_FN float feature(const GradientFields& f, int i) const {
    float by_velocity = 0;
    float by_density = 0;
    for (const Vec4& a : axis) {
      by_velocity += dot(xyz(a), xyz(a));
      by_density += a.w * a.w;
    }
    const float scale = f.dimensionless ? f.position[i].w : 1;
    return scale * (sqrtf(by_density) / (f.density[i] + f.density_epsilon) +
                    sqrtf(by_velocity) / (length(xyz(f.velocity[i])) + f.speed_epsilon));
  }
};

SIM_FN float pair_support(const GradientFields& f, int i, int j) {
  return 0.5f * (f.position[i].w + f.position[j].w);
}

/// Weight of neighbour j in an average around particle i: m_j W_ij, without the factors that all neighbours
/// of i share.
SIM_FN float average_weight(const GradientFields& f, int i, int j) {
  const Vec4 other = f.position[j];
  const Vec3 offset = xyz(f.position[i]) - xyz(other);
  return other.w * other.w * other.w * Kernel(pair_support(f, i, j)).density(dot(offset, offset));
}

struct WithinH {
  GradientFields fields;
  ParticleNeighbours neighbours;
  template <class Team>
  SIM_FN void operator()(int i, Team team) const {
    Gradients sum;
    const Vec4 own = quantities(fields, i);
    const int size = neighbours.size(i);
    const NeighbourRun run = neighbours.run(i);
    for (int k = team.rank(); k < size; k += Team::size) {
      const int j = run[k];
      sum.add_pair(fields, i, j, pair_support(fields, i, j), own, quantities(fields, j));
    }
    sum.sum_over(team);
    if (team.rank() == 0) fields.out[i] = sum.feature(fields, i);
  }
};

struct AverageFields {
  GradientFields fields;
  ParticleNeighbours neighbours;
  Vec4* averages;
  template <class Team>
  SIM_FN void operator()(int i, Team team) const {
    float total = 0;
    Vec4 sum = {0, 0, 0, 0};
    const auto add = [&](int j) {
      const float weight = average_weight(fields, i, j);
      const Vec4 q = quantities(fields, j);
      sum = {sum.x + weight * q.x, sum.y + weight * q.y, sum.z + weight * q.z, sum.w + weight * q.w};
      total += weight;
    };
    if (team.rank() == 0) add(i);
    const int size = neighbours.size(i);
    const NeighbourRun run = neighbours.run(i);
    for (int k = team.rank(); k < size; k += Team::size) add(run[k]);
    sum = {team.sum(sum.x), team.sum(sum.y), team.sum(sum.z), team.sum(sum.w)};
    total = team.sum(total);
    if (team.rank() > 0) return;
    averages[i] = {sum.x / total, sum.y / total, sum.z / total, sum.w / total};
  }
};

struct GradientsOfAverages {
  GradientFields fields;
  ParticleNeighbours neighbours;
  const Vec4* averages;
  Gradients* gradients;
  template <class Team>
  SIM_FN void operator()(int i, Team team) const {
    Gradients sum;
    const int size = neighbours.size(i);
    const NeighbourRun run = neighbours.run(i);
    for (int k = team.rank(); k < size; k += Team::size) {
      const int j = run[k];
      sum.add_pair(fields, i, j, pair_support(fields, i, j), averages[i], averages[j]);
    }
    sum.sum_over(team);
    if (team.rank() == 0) gradients[i] = sum;
  }
};

struct AverageGradients {
  GradientFields fields;
  ParticleNeighbours neighbours;
  const Gradients* gradients;
  template <class Team>
  SIM_FN void operator()(int i, Team team) const {
    float total = 0;
    Gradients sum;
    const auto add = [&](int j) {
      const float weight = average_weight(fields, i, j);
      sum.add(weight, gradients[j]);
      total += weight;
    };
    if (team.rank() == 0) add(i);
    const int size = neighbours.size(i);
    const NeighbourRun run = neighbours.run(i);
    for (int k = team.rank(); k < size; k += Team::size) add(run[k]);
    sum.sum_over(team);
    total = team.sum(total);
    if (team.rank() > 0) return;
    for (Vec4& a : sum.axis) a = {a.x / total, a.y / total, a.z / total, a.w / total};
    fields.out[i] = sum.feature(fields, i);
  }
};

SIM_FN int wide_cell(float x, float edge, int limit) {
  const auto most = static_cast<float>(limit - 8);
  return static_cast<int>(at_most(at_least(floorf(x / edge), -most), most));
}

struct WideKeys {
  const Vec4* position;
  std::uint64_t* keys;
  int* order;
  float edge;
  SIM_FN void operator()(int i) const {
    const Vec4 p = position[i];
    keys[i] = cell_key({0, wide_cell(p.x, edge, cell_limit_xz), wide_cell(p.y, edge, cell_limit_y),
                        wide_cell(p.z, edge, cell_limit_xz)});
    order[i] = i;
  }
};

/// The temporal feature from all neighbours within 2 h_i. Loops over the rows of cells in the bounding box of
/// the sphere with this radius.
struct WithinTwoH {
  GradientFields fields;
  const std::uint64_t* keys;
  const int* order;
  int n;
  float edge;

  SIM_FN void operator()(int i) const {
    const Vec4 self = fields.position[i];
    const float support = 2 * self.w;
    const int x0 = wide_cell(self.x - support, edge, cell_limit_xz);
    const int x1 = wide_cell(self.x + support, edge, cell_limit_xz);
    const int y1 = wide_cell(self.y + support, edge, cell_limit_y);
    const int z1 = wide_cell(self.z + support, edge, cell_limit_xz);
    Gradients sum;
    const Vec4 own = quantities(fields, i);
    for (int y = wide_cell(self.y - support, edge, cell_limit_y); y <= y1; ++y) {
      for (int z = wide_cell(self.z - support, edge, cell_limit_xz); z <= z1; ++z) {
        const std::uint64_t last = cell_key({0, x1, y, z});
        for (int at = lower_bound(keys, n, cell_key({0, x0, y, z})); at < n && keys[at] <= last; ++at) {
          const int j = order[at];
          if (j != i) sum.add_pair(fields, i, j, support, own, quantities(fields, j));
        }
      }
    }
    fields.out[i] = sum.feature(fields, i);
  }
};

}  // namespace

void TemporalGradients::run_smoothed(const GradientFields& fields, const ParticleNeighbours& neighbours,
                                     int n) {
  const auto size = static_cast<std::size_t>(n);
  averages_.resize(size);
  gradients_.resize(3 * size);
  static_assert(sizeof(Gradients) == 3 * sizeof(Vec4));
  auto* gradients = reinterpret_cast<Gradients*>(gradients_.data());
  for_each_team("saliency averages", n, AverageFields{fields, neighbours, averages_.data()});
  for_each_team("saliency gradients", n,
                GradientsOfAverages{fields, neighbours, averages_.data(), gradients});
  for_each_team("saliency gradients, averaged", n, AverageGradients{fields, neighbours, gradients});
}

void TemporalGradients::run_wide(const GradientFields& fields, int n, float finest_support) {
  const auto size = static_cast<std::size_t>(n);
  keys_.resize(size);
  order_.resize(size);
  const float edge = 2 * finest_support;
  for_each("saliency cells", n, WideKeys{fields.position, keys_.data(), order_.data(), edge});
  sorter_.sort(keys_, order_);
  for_each("saliency wide gradients", n, WithinTwoH{fields, keys_.data(), order_.data(), n, edge});
}

void TemporalGradients::run(GradientReach reach, const GradientFields& fields,
                            const ParticleNeighbours& neighbours, int n, float finest_support) {
  switch (reach) {
    case GradientReach::OneSupport:
      for_each_team("saliency gradients", n, WithinH{fields, neighbours});
      return;
    case GradientReach::Smoothed:
      run_smoothed(fields, neighbours, n);
      return;
    case GradientReach::TwoSupports:
      run_wide(fields, n, finest_support);
  }
}

}  // namespace sim::SIM_BACKEND
