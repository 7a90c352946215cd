#include "libsim/impulse/impulse_recorder.hpp"

#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Sums the momentum of all particles. Each index adds every `stride`th particle, to reduce contention for
/// the one sum.
struct AddMomentum {
  const Vec4* velocity;
  const std::uint8_t* level;
  int n, stride;
  MomentumSums* out;
  SIM_FN void operator()(int first) const {
    Momentum sum{};
    for (int i = first; i < n; i += stride) sum.add(static_cast<float>(1 << level[i]), xyz(velocity[i]));
    out->now.add_at_once(sum);
  }
};

struct BeginSums {
  const Guards* guards;
  MomentumSums* sums;
  SIM_FN void operator()(int) const {
    sums->first = sums->now;
    sums->last = sums->now;
    sums->taken = guards->braked;
  }
};

/// Assigns the change of momentum since the last call of mark() or begin_frame() to one cause, and the part
/// that guards removed (speed limit, particles that are not finite or far outside) to Change::Braked.
struct Count {
  int change;
  const Guards* guards;
  MomentumSums* sums;
  SIM_FN void operator()(int) const {
    const Momentum taken = guards->braked - sums->taken;
    sums->changed[change] = sums->changed[change] + ((sums->now - sums->last) + taken);
    Momentum& braked = sums->changed[static_cast<int>(Change::Braked)];
    braked = braked - taken;
    sums->last = sums->now;
    sums->taken = guards->braked;
  }
};

GaugeBox box_of(const Gauge& gauge, const Vec3d& room_m) {
  const std::string who = "gauge " + gauge.name;
  if (!(area_m2(gauge, room_m) > 0)) {
    const auto words = [](const Vec3d& v) {
      return "(" + base::shortest(v[0]) + ", " + base::shortest(v[1]) + ", " + base::shortest(v[2]) + ")";
    };
    throw base::Error(
        who, "has no area on its wall: min_m = " + words(gauge.min_m) + ", max_m = " + words(gauge.max_m),
        "give min_m < max_m along the wall, inside the tank, which extends from (0, 0, 0) to " +
            words(room_m) + " m");
  }
  constexpr double endless = 1e30;
  constexpr double edge = 1e-6;
  const Vec3d normal = inward_normal(gauge.wall);
  Vec3d low = gauge.min_m, high = gauge.max_m;
  for (std::size_t k = 0; k < 3; ++k) {
    const bool across = normal[k] != 0;
    if (across || low[k] <= edge) low[k] = -endless;
    if (across || high[k] >= room_m[k] - edge) high[k] = endless;
  }
  const auto vector = [](const Vec3d& v) {
    return Vec3{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
  };
  return {static_cast<int>(gauge.wall), vector(low), vector(high)};
}

}  // namespace

void ImpulseRecorder::begin(const std::vector<Gauge>& gauges, const Vec3d& room_m, float finest_support) {
  on_ = true;
  finest_support_ = finest_support;
  std::vector<GaugeBox> boxes;
  for (const Gauge& gauge : gauges) boxes.push_back(box_of(gauge, room_m));
  gauges_.from_host(boxes);
  walls_.resize(wall_count + boxes.size());
  walls_.zero();
  sums_.resize(1);
  sums_.zero();
}

WallRecord ImpulseRecorder::record_to(float times) {
  return {walls_.data(), gauges_.data(), static_cast<int>(gauges_.size()), finest_support_, times};
}

void ImpulseRecorder::sum_up(const Particles& particles) {
  const int n = particles.size();
  const int lookers = (n + 31) / 32;
  const auto& p = particles.all();
  fill_zero(&sums_.data()->now, sizeof(Momentum));
  for_each("sum momentum", lookers,
           AddMomentum{.velocity = p.velocity.data(),
                       .level = p.level.data(),
                       .n = n,
                       .stride = lookers,
                       .out = sums_.data()});
}

void ImpulseRecorder::begin_frame(const Particles& particles, const Guards* guards) {
  if (!on_) return;
  walls_.zero();
  sums_.zero();
  sum_up(particles);
  for_each("begin momentum", 1, BeginSums{guards, sums_.data()});
}

void ImpulseRecorder::mark(Change as, const Particles& particles, const Guards* guards) {
  if (!on_ || as == Change::None) return;
  sum_up(particles);
  for_each("mark momentum", 1, Count{static_cast<int>(as), guards, sums_.data()});
}

MomentumAccount ImpulseRecorder::end_frame(float rest_density, float dt) {
  MomentumAccount out;
  if (!on_) return out;
  const auto edge = static_cast<double>(finest_support_) / 2;
  const double unit_mass = static_cast<double>(rest_density) * edge * edge * edge;
  const auto walls = walls_.to_host();
  const auto push = [&](const WallSum& sum) {
    const auto part = [&](WallPart which) {
      const auto fixed = static_cast<std::int64_t>(sum.parts[static_cast<std::size_t>(which)]);
      return unit_mass * static_cast<double>(WallSum::unit) * static_cast<double>(fixed) /
             static_cast<double>(dt);
    };
    return WallPush{part(WallPart::MissingDensity), part(WallPart::CoarsePressure), part(WallPart::Clamp)};
  };
  for (std::size_t k = 0; k < wall_count; ++k) out.walls[k] = push(walls[k]);
  for (std::size_t k = wall_count; k < walls.size(); ++k) out.gauges.push_back(push(walls[k]));

  const MomentumSums sums = sums_.to_host()[0];
  const auto vector = [&](const Momentum& sum) {
    const auto in_units = [&](std::uint64_t fixed) {
      return unit_mass * static_cast<double>(Momentum::unit) *
             static_cast<double>(static_cast<std::int64_t>(fixed));
    };
    return Vec3d{in_units(sum.x), in_units(sum.y), in_units(sum.z)};
  };
  const auto changed = [&](Change as) { return vector(sums.changed[static_cast<std::size_t>(as)]); };
  out.forces = changed(Change::Forces);
  out.flow = changed(Change::Flow);
  out.levels = changed(Change::Levels);
  out.braked = changed(Change::Braked);
  out.viscosity = changed(Change::Viscosity);
  out.effects = changed(Change::Effects);
  out.inherited = changed(Change::Inherited);
  out.before = vector(sums.first);
  out.after = vector(sums.last);
  out.unattributed = changed(Change::Projections);
  const Vec3d walls_gave = out.walls_sum();
  for (std::size_t k = 0; k < 3; ++k) out.unattributed[k] -= walls_gave[k];
  return out;
}

}  // namespace sim::SIM_BACKEND
