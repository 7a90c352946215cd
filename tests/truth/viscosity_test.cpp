/// Viscosity measured back from the motion.

#include "libsim/scene/effects.hpp"
#include "tests/truth/truth_helpers.hpp"

namespace {

using namespace truth_test;
using sim::EffectKind;

double env(const char* name, double usual) {
  const char* v = std::getenv(name);
  return v ? std::atof(v) : usual;
}

struct Cell {
  int level = 0;
  bool mixed = false;
  double beta = 1;
  double nu = 0.1;
};

sim::Effect viscosity(double nu, double stick, double steps) {
  sim::Effect out{EffectKind::Viscosity, nu};
  out.options[static_cast<std::size_t>(sim::EffectOption::ViscosityStick)] = stick;
  out.options[static_cast<std::size_t>(sim::EffectOption::ViscositySteps)] = steps;
  return out;
}

TEST(VExplore, TaylorGreen) {
  const int level = static_cast<int>(env("LEVEL", 0));
  const bool mixed = env("MIXED", 0) > 0;
  const double beta = env("BETA", 1), nu = env("NU", 0.1), steps = env("STEPS", 30), U = env("U", 0.3);
  const int spacings = static_cast<int>(env("SPACINGS", 16));
  const double d = 0.05, spacing = d * std::cbrt(1 << level), length = spacings * spacing;
  auto scene = fluid_test::tank({length, 2 * length, length}, {length, length, length}, 0);
  scene.gravity_m_s2 = env("G", 9.81);
  scene.effects = {viscosity(nu, 0, steps)};
  scene.viscosity_m2_s = env("XSPH", 0);
  sim::SimulationOptions options;
  options.method = mixed ? MethodKind::Ours : level == 0 ? MethodKind::HiRes : MethodKind::LoRes;
  options.n_star = std::llround(std::pow(length / d, 3) / 8);
  options.substeps = static_cast<int>(env("SUB", 2));
  if (mixed) options.forced_targets = sim::TargetRegion{{0, length/2, length/2}, 0.7*length, 0, 3};
  if (beta < 1) {
    options.temporal.always = true;
    options.temporal.fixed_tau = std::log(beta) / (2 * 0.02);
  }
  const auto fluid = sim::make_simulation(scene, options);
  for (int k = 0; k < env("SETTLE", 60); ++k) fluid->step_frame();
  const double k = pi / length;
  const auto flow = [&](const Vec3d& x) {
    return Vec3d{U * std::sin(k * x[0]) * std::cos(k * x[2]), 0, -U * std::cos(k * x[0]) * std::sin(k * x[2])};
  };
  const auto strength = [&](const State& state) {
    double along = 0, norm = 0;
    for (const auto& p : state) {
      const Vec3d v = velocity(p), e = flow(place(p));
      along += mass(p) * (v[0] * e[0] + v[2] * e[2]);
      norm += mass(p) * (e[0] * e[0] + e[2] * e[2]);
    }
    return along / norm;
  };
  fluid->put(moving(fluid->read_state(), flow));
  std::vector<double> t, logs;
  const double rate = 2 * nu * k * k;
  const int frames = static_cast<int>(std::ceil(1.5 / rate / scene.frame_dt_s));
  for (int f = 1; f <= frames; ++f) {
    fluid->step_frame();
    t.push_back(f * scene.frame_dt_s);
    logs.push_back(std::log(std::max(1e-3, strength(fluid->read_state()))));
  }
  const double back = -fit(t, logs).slope / (2 * k * k);
  std::string levels;
  for (const auto n : fluid->report().particles_by_level) levels += " " + std::to_string(n);
  std::printf("TG level %d mixed %d beta %.2f nu %.3f: %d frames, back %.3f r2 %.4f first %.3f last %.3f levels%s\n", level, mixed,
              beta, nu, frames, back / nu, fit(t, logs).r2, logs.front() / (-rate * t.front()), logs.back() / (-rate * t.back()), levels.c_str());
}

TEST(VExplore, Wave) {
  const int level = static_cast<int>(env("LEVEL", 0));
  const bool mixed = env("MIXED", 0) > 0;
  const double beta = env("BETA", 1), steps = env("STEPS", 30), stick = env("STICK", 1), way = env("WAY", 2);
  const int n = static_cast<int>(env("SPACINGS", 12)), len = static_cast<int>(env("LEN", 3));
  const double d = 0.05, spacing = d * std::cbrt(1 << level), a = n * spacing;
  const double nu = env("NU", 0.3) * std::pow(1 << level, 0.5);
  const double tau = a * a / ((1 + stick) * pi * pi * nu), U = way * spacing / tau;
  auto scene = fluid_test::tank({a, (len + 3) * a, a}, {a, a, a}, 0);
  scene.effects = {viscosity(nu, stick, steps)};
  scene.viscosity_m2_s = 0;
  scene.gravity_m_s2 = 0;
  sim::SimulationOptions options;
  options.method = mixed ? MethodKind::Ours : level == 0 ? MethodKind::HiRes : MethodKind::LoRes;
  const double middle = (len + 3) * a / 2;
  const auto flow = [&](const Vec3d& x) {
    return Vec3d{0, U * (stick > 0 ? std::sin(pi * x[0] / a) * std::sin(pi * x[2] / a) : std::cos(pi * x[0] / a)), 0};
  };
  State start = lattice(spacing, scene.tank_size_m, [&](const Vec3d& x) { return std::abs(x[1] - middle) < len * a / 2; }, [](const Vec3d&) { return Vec3d{}; });
  for (auto& p : start) p.level = level;
  options.n_star = static_cast<std::int64_t>(start.size() << level) / 8 + 1;
  scene.fill_max_m = {2 * d * static_cast<double>(options.n_star), 2 * d, 2 * d};
  scene.frame_dt_s = tau / env("FRAMES", 12);
  options.substeps = static_cast<int>(env("SUB", 2));
  options.start = start;
  if (mixed) options.forced_targets = sim::TargetRegion{{a / 2, middle, a}, 0.5 * a, 0, 3};
  if (beta < 1) {
    options.temporal.always = true;
    options.temporal.fixed_tau = std::log(beta) / (2 * 0.02);
  }
  const auto fluid = sim::make_simulation(scene, options);
  for (int k = 0; k < env("SETTLE", 10); ++k) fluid->step_frame();
  fluid->put(moving(fluid->read_state(), flow));
  const auto strength = [&](const State& state) {
    double along = 0, norm = 0;
    const double ym = mean(state, [](auto& p) { return place(p)[1]; });
    for (const auto& p : state) {
      const Vec3d v = velocity(p), e = flow(place(p));
      if (std::abs(place(p)[1] - ym) > a / 2) continue;
      along += mass(p) * v[1] * e[1];
      norm += mass(p) * e[1] * e[1];
    }
    return along / norm;
  };
  std::vector<double> t, logs;
  for (int f = 1; f <= static_cast<int>(env("FRAMES", 12)); ++f) {
    fluid->step_frame();
    t.push_back(f * scene.frame_dt_s / tau);
    logs.push_back(std::log(std::max(1e-3, strength(fluid->read_state()))));
  }
  std::string levels;
  for (const auto c : fluid->report().particles_by_level) levels += " " + std::to_string(c);
  std::printf("wave stick %.0f level %d mixed %d beta %.2f nu %.3f U %.2f dt %.4f: back %.3f r2 %.4f first %.3f last %.3f levels%s\n", stick, level, mixed,
              beta, nu, U, scene.frame_dt_s / options.substeps, -fit(t, logs).slope, fit(t, logs).r2, -logs.front() / t.front(), -logs.back() / t.back(), levels.c_str());
}

}  // namespace
