#pragma once
/// Shared by the tests against experiments and closed forms: runs from given particles, sums over their mass,
/// fits. Lengths are in metres, times in seconds.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numeric>

#include "libsim/scene/fill.hpp"
#include "tests/libsim/fluid_helpers.hpp"
#include "tests/truth/truth_file.hpp"

namespace truth_test {

using fluid_test::ParticleState;
using sim::Backend;
using sim::MethodKind;
using sim::Vec3d;
using State = std::vector<ParticleState>;

inline constexpr double pi = 3.14159265358979323846;

/// The methods with which most tests against data/truth run.
inline constexpr std::array methods{MethodKind::HiRes, MethodKind::Ours};

struct Run {
  Backend backend;
  MethodKind method;
  bool ours() const { return method == MethodKind::Ours; }
  std::string name() const { return sim::method_name(method); }
};

using sim::cases::mass;
inline double total_mass(const State& state) {
  return std::accumulate(state.begin(), state.end(), 0.0,
                         [](double sum, const auto& p) { return sum + mass(p); });
}
/// Mean of f over the water's mass.
template <typename F>
double mean(const State& state, F f) {
  double sum = 0;
  for (const auto& p : state) sum += mass(p) * f(p);
  return sum / total_mass(state);
}
inline Vec3d place(const ParticleState& p) {
  return {static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(p.z_m)};
}
inline Vec3d velocity(const ParticleState& p) {
  return {static_cast<double>(p.vx_m_s), static_cast<double>(p.vy_m_s), static_cast<double>(p.vz_m_s)};
}

/// Particles of level 0 on the lattice of spacing d in the box [0, size] where `inside` returns true, with
/// velocity `speed`.
inline State lattice(double d, const Vec3d& size, const std::function<bool(const Vec3d&)>& inside,
                     const std::function<Vec3d(const Vec3d&)>& speed) {
  State out;
  const auto count = [&](std::size_t axis) { return static_cast<int>(std::llround(size[axis] / d)); };
  for (int y = 0; y < count(1); ++y) {
    for (int z = 0; z < count(2); ++z) {
      for (int x = 0; x < count(0); ++x) {
        const Vec3d at{(x + 0.5) * d, (y + 0.5) * d, (z + 0.5) * d};
        if (!inside(at)) continue;
        const Vec3d v = speed(at);
        const auto f = [](double value) { return static_cast<float>(value); };
        out.push_back(
            {static_cast<int>(out.size()), 0, f(at[0]), f(at[1]), f(at[2]), f(v[0]), f(v[1]), f(v[2])});
      }
    }
  }
  return out;
}

/// The same particles with velocity `speed`.
inline State moving(State state, const std::function<Vec3d(const Vec3d&)>& speed) {
  for (auto& p : state) {
    const Vec3d v = speed(place(p));
    p.vx_m_s = static_cast<float>(v[0]);
    p.vy_m_s = static_cast<float>(v[1]);
    p.vz_m_s = static_cast<float>(v[2]);
  }
  return state;
}

/// Makes a run of a scene whose level 0 has spacing d start with these particles, all of level `level`.
inline void begin_with(State start, int level, double d, sim::Scene& scene, sim::SimulationOptions& options) {
  for (auto& p : start) p.level = level;
  options.n_star = static_cast<std::int64_t>(start.size() << level) / 8 + 1;
  scene.water.front().max_m = {2 * d * static_cast<double>(options.n_star), 2 * d,
                               2 * d};  // 8 n_star cubes of edge d
  options.start = std::move(start);
}

/// Turns on temporal acceleration for any method, with `beta` as the lowest probability that a particle is
/// solved in a frame; beta 1 turns nothing on.
inline void rest_at(double beta, sim::SimulationOptions& options) {
  if (beta == 1) return;
  options.temporal.always = true;
  options.temporal.fixed_tau = std::log(beta) / (2 * 0.02);  // beta = exp(2 b tau) with b = 0.02
}

/// A run from particles of level 0 at spacing d, seen from the front (+z) at a distance of three times the
/// tank's width, so that the fovea (7.5 degrees on each side) is 0.8 of this width across.
inline std::unique_ptr<sim::Simulation> start_from(const Run& run, sim::Scene scene, double d,
                                                   const State& start, sim::SimulationOptions options = {}) {
  options.n_star = (static_cast<std::int64_t>(start.size()) + 7) / 8;
  scene.water.front().max_m = {2 * d * static_cast<double>(options.n_star), 2 * d,
                               2 * d};  // 8 n_star cubes of edge d
  const Vec3d middle{mean(start, [](auto& p) { return place(p)[0]; }),
                     mean(start, [](auto& p) { return place(p)[1]; }), scene.tank_size_m[2] / 2};
  scene.view.target_m = middle;
  scene.view.eye_m = {middle[0], middle[1], middle[2] + 3 * scene.tank_size_m[0]};
  options.backend = run.backend;
  options.method = run.method;
  options.start = start;
  return sim::make_simulation(scene, options);
}

/// Particles of level 0 that fill [0, size] of a tank of that plan, at rest after `frames` under gravity.
inline State settled(Backend backend, const Vec3d& size, double d, int frames) {
  auto scene = fluid_test::tank({size[0], 2 * size[1], size[2]}, size, frames);
  sim::SimulationOptions options;
  options.backend = backend;
  options.n_star = std::llround(size[0] * size[1] * size[2] / (8 * d * d * d));
  return sim::make_simulation(scene, options)->read_state();
}

/// Options of a run for comparison with an inviscid closed form: no XSPH, and four substeps a frame because
/// they dissipate less than two.
inline sim::SimulationOptions inviscid() {
  sim::SimulationOptions out;
  out.viscosity_m2_s = 0;
  out.substeps = 4;
  return out;
}

/// "1234 particles of 4321": the particles of the run, of those at the start.
inline std::string share(const sim::Simulation& fluid, const State& start) {
  return std::to_string(fluid.particle_count()) + " particles of " + std::to_string(start.size());
}

/// y = intercept + slope x by least squares.
struct Line {
  double slope = 0, intercept = 0, r2 = 0;
};
inline Line fit(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sx += x[i];
    sy += y[i];
    sxx += x[i] * x[i];
    sxy += x[i] * y[i];
    syy += y[i] * y[i];
  }
  const double cxy = sxy - sx * sy / n, cxx = sxx - sx * sx / n, cyy = syy - sy * sy / n;
  return {cxy / cxx, (sy - cxy / cxx * sx) / n, cxy * cxy / (cxx * cyy)};
}

/// ys at x, by linear interpolation; beyond the ends, the value of the end.
inline double interpolate(const std::vector<double>& xs, const std::vector<double>& ys, double x) {
  const auto above = std::upper_bound(xs.begin(), xs.end(), x);
  if (above == xs.begin()) return ys.front();
  if (above == xs.end()) return ys.back();
  const auto i = static_cast<std::size_t>(above - xs.begin());
  const double t = (x - xs[i - 1]) / (xs[i] - xs[i - 1]);
  return ys[i - 1] + t * (ys[i] - ys[i - 1]);
}

/// Root mean square of a run's distance from a file's points, over the largest of them, after the best shift
/// in time within +- `most` of the file's unit.
struct Match {
  double error = 1e9, shift = 0;
};
inline Match best_match(const std::vector<double>& t, const std::vector<double>& y,
                        const std::vector<double>& t_ref, const std::vector<double>& y_ref, double most) {
  Match best;
  const double largest = *std::max_element(y_ref.begin(), y_ref.end());
  constexpr int steps = 20;
  for (int k = -steps; k <= steps; ++k) {
    const double shift = most * k / steps;
    double sum = 0;
    for (std::size_t i = 0; i < t_ref.size(); ++i) {
      const double error = interpolate(t, y, t_ref[i] + shift) - y_ref[i];
      sum += error * error;
    }
    const double error = std::sqrt(sum / static_cast<double>(t_ref.size())) / largest;
    if (error < best.error) best = {error, shift};
  }
  return best;
}

/// Expects a value of at most the gate. Without a gate the value must only be finite.
inline void expect_within(double value, const std::optional<double>& gate, const std::string& what) {
  if (gate) {
    EXPECT_LE(value, *gate) << what;
  } else {
    EXPECT_TRUE(std::isfinite(value)) << what;
  }
}

/// The scene file beside the truth file, or else among the project's scenes.
inline std::filesystem::path scene_of(const TruthFile& file) {
  const auto beside = file.path.parent_path() / file.text("scene");
  return std::filesystem::exists(beside) ? beside : base::resource("data/scenes/" + file.text("scene"));
}

}  // namespace truth_test
