#include <fmt/core.h>
#include <algorithm>
#include <cmath>

#include "libsim/bake/codec.hpp"
#include "libsim/bake/quantise.hpp"

namespace sim {

namespace {

using bake::Axis;
using Box = std::array<Axis, 3>;

float coordinate(const RenderParticle& particle, std::size_t axis) {
  return axis == 0 ? particle.x_m : axis == 1 ? particle.y_m : particle.z_m;
}

Box bounding_box(const std::vector<RenderParticle>& particles, const std::string& place) {
  Box box{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    bool first = true;
    for (const RenderParticle& particle : particles) {
      const float x = coordinate(particle, axis);
      if (!std::isfinite(x)) {
        throw base::Error(place, "a particle's position is not finite",
                          "the simulation has failed; raise time.min_substeps in the scene file");
      }
      box[axis].min = first ? x : std::min(box[axis].min, x);
      box[axis].max = first ? x : std::max(box[axis].max, x);
      first = false;
    }
  }
  return box;
}

void check_error(const Box& box, const std::vector<float>& radii, const std::string& place) {
  const float finest = *std::min_element(radii.begin(), radii.end());
  for (const Axis& axis : box) {
    const double error = bake::error_of(axis);
    if (error < double(finest) / 20) continue;
    throw base::Error(
        place,
        fmt::format("particles spread over {:.4g} m, which 16 bit resolve to {:.3g} m; radius "
                    "{:.3g} m needs a twentieth",
                    axis.max - axis.min, error, finest),
        "keep the fluid inside the tank, or use a smaller n_* (--n-star, or n_star in a protocol)");
  }
}

/// Indices of the particles by level, in input order within a level.
std::vector<std::uint32_t> order_by_level(const std::vector<RenderParticle>& particles,
                                          const std::vector<float>& radii, const std::string& place,
                                          std::vector<std::int64_t>& counts) {
  std::vector<std::uint8_t> level(particles.size());
  counts.assign(radii.size(), 0);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const auto found = std::find(radii.begin(), radii.end(), particles[i].radius_m);
    if (found == radii.end()) {
      throw base::Error(place, "a particle's radius is none of the bake's levels",
                        "name every radius in the header");
    }
    level[i] = static_cast<std::uint8_t>(found - radii.begin());
    ++counts[level[i]];
  }
  std::vector<std::uint32_t> order;
  order.reserve(particles.size());
  for (std::size_t wanted = 0; wanted < radii.size(); ++wanted) {
    for (std::size_t i = 0; i < particles.size(); ++i) {
      if (level[i] == wanted) order.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return order;
}

Axis temperature_range(const std::vector<float>& temperature_k, const std::string& place) {
  Axis range;
  for (std::size_t i = 0; i < temperature_k.size(); ++i) {
    const float one = temperature_k[i];
    if (!std::isfinite(one)) {
      throw base::Error(place, "a particle's temperature is not finite",
                        "the simulation has failed; raise time.min_substeps in the scene file");
    }
    range.min = i == 0 ? one : std::min(range.min, one);
    range.max = i == 0 ? one : std::max(range.max, one);
  }
  if (bake::error_of(range) <= max_temperature_error_k) return range;
  throw base::Error(place,
                    fmt::format("temperatures span {:.4g} K, which 16 bit resolve to {:.3g} K only",
                                double(range.max) - double(range.min), bake::error_of(range)),
                    "the simulation has failed; raise time.min_substeps in the scene file");
}

}  // namespace

void encode_particles(double time_s, const FrameAccount& account,
                      const std::vector<RenderParticle>& particles,
                      const std::vector<float>& radius_by_level_m, const std::vector<float>* temperature_k,
                      int zstd_level, const std::string& place, Bytes& out) {
  if (particles.size() > static_cast<std::size_t>(max_bake_particles)) {
    throw base::Error(place, "holds more particles than a bake may",
                      "use a smaller n_* (--n-star, or n_star in a protocol)");
  }
  BakeFacts facts{time_s, account};
  const auto order = order_by_level(particles, radius_by_level_m, place, facts.account.particles_by_level);
  const Box box = bounding_box(particles, place);
  check_error(box, radius_by_level_m, place);

  out.clear();
  ByteWriter writer(out);
  put_facts(writer, facts);
  bake::put_axes(writer, box);
  Bytes planes((temperature_k ? 8 : 6) * particles.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    bake::encode_axis(
        order.size(), [&](std::size_t i) { return coordinate(particles[order[i]], axis); }, box[axis],
        planes.data() + 2 * axis * particles.size());
  }
  if (temperature_k) {
    const Axis range = temperature_range(*temperature_k, place);
    bake::put_axes<1>(writer, {range});
    bake::encode_axis(
        order.size(), [&](std::size_t i) { return (*temperature_k)[order[i]]; }, range,
        planes.data() + 6 * particles.size());
  }
  pack(planes, zstd_level, out);
}

void decode_particles(ByteSpan payload, const ParticleLayout& layout, const std::string& place,
                      Bytes& scratch, BakeFrame& out) {
  const auto& radius_by_level_m = layout.radius_by_level_m;
  ByteReader in(payload, place);
  out.facts = get_facts(in, layout.format, radius_by_level_m.size());
  const std::int64_t total = out.facts.account.particles();
  if (total > layout.max_particles) in.fail("states " + std::to_string(total) + " particles");
  const Box box = bake::get_axes<3>(in);
  const Axis warmth = layout.temperatures ? bake::get_axes<1>(in)[0] : Axis{};
  const auto n = static_cast<std::size_t>(total);
  unpack(in, (layout.temperatures ? 8 : 6) * n, scratch);

  out.particles.resize(n);
  RenderParticle* particles = out.particles.data();
  const std::uint8_t* planes = scratch.data();
  bake::decode_axis(planes, n, box[0], [=](std::size_t i, float x) { particles[i].x_m = x; });
  bake::decode_axis(planes + 2 * n, n, box[1], [=](std::size_t i, float y) { particles[i].y_m = y; });
  bake::decode_axis(planes + 4 * n, n, box[2], [=](std::size_t i, float z) { particles[i].z_m = z; });
  std::size_t begin = 0;
  for (std::size_t level = 0; level < radius_by_level_m.size(); ++level) {
    const std::size_t end = begin + static_cast<std::size_t>(out.facts.account.particles_by_level[level]);
    for (std::size_t i = begin; i < end; ++i) particles[i].radius_m = radius_by_level_m[level];
    begin = end;
  }
  out.temperature_k.resize(layout.temperatures ? n : 0);
  out.temperature_error_k = bake::error_of(warmth);
  if (!layout.temperatures) return;
  float* kelvin = out.temperature_k.data();
  bake::decode_axis(planes + 6 * n, n, warmth, [=](std::size_t i, float k) { kelvin[i] = k; });
}

}  // namespace sim
