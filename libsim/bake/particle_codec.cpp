#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "libsim/bake/bytes.hpp"
#include "libsim/bake/codec.hpp"

namespace sim {

namespace {

// Numbers are stored with 16 bit over their range: a range of extent e has an error of at most e / 131070.

constexpr float axis_steps = 65535;

/// Range of the values of one quantity in a frame.
struct Axis {
  float min = 0, max = 0;
};

/// Upper bound, without float rounding, on the error of a number that is stored with 16 bit over this range.
double error_of(const Axis& range) {
  return (double(range.max) - double(range.min)) / (2 * double(axis_steps));
}

/// Maps differences of small magnitude and either sign to small unsigned numbers.
std::uint16_t zigzag(std::uint16_t difference) {
  return static_cast<std::uint16_t>((difference << 1) ^ ((difference & 0x8000) ? 0xffff : 0));
}
std::uint16_t unzigzag(std::uint16_t value) {
  return static_cast<std::uint16_t>((value >> 1) ^ ((value & 1) ? 0xffff : 0));
}

/// Encodes n values as planes: n high bytes, then n low bytes, of the differences between consecutive values.
template <typename Value>
void encode_axis(std::size_t n, Value value, const Axis& range, std::uint8_t* planes) {
  const double scale = range.max > range.min ? 65535.0 / (double(range.max) - double(range.min)) : 0;
  std::uint16_t before = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double offset = double(value(i)) - double(range.min);
    const auto q = static_cast<std::uint16_t>(std::clamp(std::lround(offset * scale), 0L, 65535L));
    const std::uint16_t code = zigzag(static_cast<std::uint16_t>(q - before));
    planes[i] = static_cast<std::uint8_t>(code >> 8);
    planes[n + i] = static_cast<std::uint8_t>(code & 0xff);
    before = q;
  }
}

/// Inverse of encode_axis(): sums the differences and passes each value to `set`.
template <typename Set>
void decode_axis(const std::uint8_t* planes, std::size_t n, const Axis& range, Set set) {
  const float scale = (range.max - range.min) / axis_steps;
  std::uint16_t q = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto code = static_cast<std::uint16_t>(planes[i] << 8 | planes[n + i]);
    q = static_cast<std::uint16_t>(q + unzigzag(code));
    set(i, range.min + scale * static_cast<float>(q));
  }
}

template <std::size_t count>
void put_axes(ByteWriter& out, const std::array<Axis, count>& axes) {
  for (const Axis& axis : axes) {
    out.put(axis.min);
    out.put(axis.max);
  }
}

template <std::size_t count>
std::array<Axis, count> get_axes(ByteReader& in) {
  std::array<Axis, count> axes{};
  for (Axis& axis : axes) {
    axis.min = in.get<float>();
    axis.max = in.get<float>();
    if (!std::isfinite(axis.min) || !std::isfinite(axis.max) || axis.max < axis.min ||
        !std::isfinite(axis.max - axis.min)) {
      in.fail(fmt::format("states values from {:g} to {:g}, which is not a valid range", axis.min, axis.max));
    }
  }
  return axes;
}

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
    const double error = error_of(axis);
    if (error < double(finest) / 20) continue;
    throw base::Error(
        place,
        fmt::format("particles spread over {:.4g} m, which 16 bit resolve to {:.3g} m; at most a "
                    "twentieth of the radius {:.3g} m is allowed",
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
      throw base::Error(
          place,
          fmt::format("a particle's radius of {:g} m is not among the header's radii", particles[i].radius_m),
          "list every radius in radius_by_level_m of the header");
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
  if (error_of(range) <= max_temperature_error_k) return range;
  throw base::Error(
      place,
      fmt::format("temperatures span {:.4g} K, which 16 bit resolve to {:.3g} K; at most {:.3g} K is allowed",
                  double(range.max) - double(range.min), error_of(range), max_temperature_error_k),
      "the simulation has failed; raise time.min_substeps in the scene file");
}

}  // namespace

void encode_particles(double time_s, const FrameAccount& account,
                      const std::vector<RenderParticle>& particles,
                      const std::vector<float>& radius_by_level_m, const std::vector<float>* temperature_k,
                      int zstd_level, const std::string& place, Bytes& out) {
  if (particles.size() > static_cast<std::size_t>(max_bake_particles)) {
    throw base::Error(place,
                      "has " + std::to_string(particles.size()) + " particles; a bake stores at most " +
                          std::to_string(max_bake_particles),
                      "use a smaller n_* (--n-star, or n_star in a protocol)");
  }
  BakeFacts facts{time_s, account};
  const auto order = order_by_level(particles, radius_by_level_m, place, facts.account.particles_by_level);
  const Box box = bounding_box(particles, place);
  check_error(box, radius_by_level_m, place);

  out.clear();
  ByteWriter writer(out);
  put_facts(writer, facts);
  put_axes(writer, box);
  Bytes planes((temperature_k ? 8 : 6) * particles.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    encode_axis(
        order.size(), [&](std::size_t i) { return coordinate(particles[order[i]], axis); }, box[axis],
        planes.data() + 2 * axis * particles.size());
  }
  if (temperature_k) {
    const Axis range = temperature_range(*temperature_k, place);
    put_axes<1>(writer, {range});
    encode_axis(
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
  if (total > layout.max_particles)
    in.fail("states " + std::to_string(total) + " particles; its header allows " +
            std::to_string(layout.max_particles));
  const Box box = get_axes<3>(in);
  const Axis warmth = layout.temperatures ? get_axes<1>(in)[0] : Axis{};
  const auto n = static_cast<std::size_t>(total);
  unpack(in, (layout.temperatures ? 8 : 6) * n, scratch);

  out.particles.resize(n);
  RenderParticle* particles = out.particles.data();
  const std::uint8_t* planes = scratch.data();
  decode_axis(planes, n, box[0], [=](std::size_t i, float x) { particles[i].x_m = x; });
  decode_axis(planes + 2 * n, n, box[1], [=](std::size_t i, float y) { particles[i].y_m = y; });
  decode_axis(planes + 4 * n, n, box[2], [=](std::size_t i, float z) { particles[i].z_m = z; });
  std::size_t begin = 0;
  for (std::size_t level = 0; level < radius_by_level_m.size(); ++level) {
    const std::size_t end = begin + static_cast<std::size_t>(out.facts.account.particles_by_level[level]);
    for (std::size_t i = begin; i < end; ++i) particles[i].radius_m = radius_by_level_m[level];
    begin = end;
  }
  out.temperature_k.resize(layout.temperatures ? n : 0);
  out.temperature_error_k = error_of(warmth);
  if (!layout.temperatures) return;
  float* kelvin = out.temperature_k.data();
  decode_axis(planes + 6 * n, n, warmth, [=](std::size_t i, float k) { kelvin[i] = k; });
}

namespace {

using Fields = std::array<float, 4>;
constexpr std::size_t fields = 4;

Fields fields_of(const RenderParticle& particle) {
  return {particle.x_m, particle.y_m, particle.z_m, particle.radius_m};
}

std::array<Axis, fields> ranges_of(const std::vector<RenderParticle>& foam, const std::string& place) {
  std::array<Axis, fields> out{};
  for (std::size_t i = 0; i < foam.size(); ++i) {
    const Fields values = fields_of(foam[i]);
    for (std::size_t k = 0; k < fields; ++k) {
      if (!std::isfinite(values[k]) || (k == 3 && values[k] <= 0))
        throw base::Error(place, "a foam particle's position is not finite, or its radius is not above 0",
                          "the simulation has failed; raise time.min_substeps in the scene file");
      out[k].min = i == 0 ? values[k] : std::min(out[k].min, values[k]);
      out[k].max = i == 0 ? values[k] : std::max(out[k].max, values[k]);
    }
  }
  return out;
}

}  // namespace

void encode_foam(const std::vector<RenderParticle>& foam, int zstd_level, const std::string& place,
                 Bytes& out) {
  const auto ranges = ranges_of(foam, place);
  out.clear();
  ByteWriter writer(out);
  writer.put(static_cast<std::uint32_t>(foam.size()));
  put_axes(writer, ranges);
  Bytes planes(2 * fields * foam.size());
  for (std::size_t k = 0; k < fields; ++k) {
    encode_axis(
        foam.size(), [&](std::size_t i) { return fields_of(foam[i])[k]; }, ranges[k],
        planes.data() + 2 * k * foam.size());
  }
  pack(planes, zstd_level, out);
}

void decode_foam(ByteSpan payload, std::int64_t max_foam, const std::string& place, Bytes& scratch,
                 std::vector<RenderParticle>& out) {
  ByteReader in(payload, place);
  const std::size_t n = in.get<std::uint32_t>();
  if (static_cast<std::int64_t>(n) > max_foam)
    in.fail("states " + std::to_string(n) + " particles of foam; its header allows " +
            std::to_string(max_foam));
  const auto ranges = get_axes<fields>(in);
  if (n > 0 && !(ranges[3].min > 0))
    in.fail(fmt::format("states a foam radius of {:g} m; a radius is above 0", ranges[3].min));
  unpack(in, 2 * fields * n, scratch);
  out.resize(n);
  RenderParticle* foam = out.data();
  const auto planes = [&](std::size_t k) { return scratch.data() + 2 * k * n; };
  decode_axis(planes(0), n, ranges[0], [=](std::size_t i, float x) { foam[i].x_m = x; });
  decode_axis(planes(1), n, ranges[1], [=](std::size_t i, float y) { foam[i].y_m = y; });
  decode_axis(planes(2), n, ranges[2], [=](std::size_t i, float z) { foam[i].z_m = z; });
  decode_axis(planes(3), n, ranges[3], [=](std::size_t i, float r) { foam[i].radius_m = r; });
}

}  // namespace sim
