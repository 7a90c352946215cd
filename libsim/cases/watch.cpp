#include "libsim/cases/watch.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace sim::cases {

Watch::Watch(const Scene& scene, const SimulationOptions& options, const Bounds& bounds)
    : scene_(scene), bounds_(bounds), fluid_(make_simulation(scene, options)), state_(fluid_->read_state()) {}

void Watch::end(const std::string& cause) {
  if (!stopped_) stopped_ = Stop{frame_, cause};
}

bool Watch::step() {
  if (stopped_) return false;
  fluid_->step_frame();
  ++frame_;
  state_ = fluid_->read_state();
  report_ = fluid_->report();
  densities_.push_back(report_.density_max);
  densest_ = std::max(densest_, report_.density_max);
  fastest_ = std::max(fastest_, report_.speed_max_m_s);
  short_frames_ += report_.substeps.taken < report_.substeps.wished;
  const int out =
      outside(state_, scene_.tank_size_m, std::isfinite(bounds_.outside_m) ? bounds_.outside_m : 1e9);
  out_ = std::max(out_, out);
  if (report_.guards.not_finite > 0) {
    end(fmt::format("{} times a particle was not finite or far outside the tank", report_.guards.not_finite));
  }
  if (out > 0) end(fmt::format("{} particles are outside the tank", out));
  if (!(densest_ <= bounds_.density)) {
    end(fmt::format("rho / rho_0 reached {:.3f}; the limit is {:.3f}", densest_, bounds_.density));
  }
  if (!(fastest_ <= bounds_.speed_m_s)) {
    end(fmt::format("a particle reached {:.2f} m/s; the limit is {:.2f} m/s", fastest_, bounds_.speed_m_s));
  }
  return !stopped_;
}

double Watch::densest_in(double share) const {
  if (densities_.empty()) return 0;
  std::vector<double> sorted = densities_;
  const double frames = std::ceil(share * static_cast<double>(sorted.size()));
  const auto last = sorted.begin() + std::max(1L, std::lround(frames)) - 1;
  std::nth_element(sorted.begin(), last, sorted.end());
  return *last;
}

Finding Watch::density_finding() const { return at_most("largest rho / rho_0", densest_, bounds_.density); }
Finding Watch::speed_finding() const { return at_most("fastest", fastest_, bounds_.speed_m_s, "m/s"); }
Finding Watch::outside_finding() const { return at_most("particles outside", out_, 0); }
Outcome Watch::outcome(std::vector<Finding> findings) const { return {std::move(findings), stopped_}; }

Scene with_effects(Scene scene, const Setting& setting) {
  scene.effects.insert(scene.effects.end(), setting.effects.begin(), setting.effects.end());
  return scene;
}

SimulationOptions options_of(const Setting& setting) {
  SimulationOptions out;
  out.method = setting.method;
  out.backend = setting.backend;
  out.frame_dt_s = setting.frame_dt_s;
  out.substeps = setting.substeps;
  out.iterations = setting.iterations;
  if (traits_of(setting.method).temporal) out.temporal.fixed_tau = -10;
  return out;
}

SimulationOptions options_of(const Setting& setting, Scene& scene, const State& start) {
  // The finest spacing follows from the volume of the water and n_*: 512 finest particles in this box give d.
  scene.water.front().min_m = {0, 0, 0};
  scene.water.front().max_m = {8 * d, 8 * d, 8 * d};
  SimulationOptions out = options_of(setting);
  out.n_star = 64;
  out.start = start;
  if (traits_of(setting.method).adaptive()) {
    out.particle_capacity = std::max<std::int64_t>(64, static_cast<std::int64_t>(start.size()));
  }
  return out;
}

double frame_dt_of(const Setting& setting, double usual) {
  return setting.frame_dt_s > 0 ? setting.frame_dt_s : usual;
}

int frames_of(const Setting& setting, double seconds, double usual_dt_s) {
  return std::max(1, static_cast<int>(std::lround(seconds / frame_dt_of(setting, usual_dt_s))));
}

Finding at_most(std::string name, double value, double limit, std::string unit) {
  return {std::move(name), value, Finding::Gate::AtMost, limit, {}, std::move(unit)};
}
Finding at_least(std::string name, double value, double limit, std::string unit) {
  return {std::move(name), value, Finding::Gate::AtLeast, limit, {}, std::move(unit)};
}
Finding reported(std::string name, double value, std::string unit) {
  return {std::move(name), value, Finding::Gate::Reported, 0, {}, std::move(unit)};
}

}  // namespace sim::cases
