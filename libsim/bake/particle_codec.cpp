#include <fmt/core.h>
#include <algorithm>
#include <cmath>

#include "libsim/bake/codec.hpp"

namespace sim {

namespace {

constexpr float steps = 65535;

/// One axis of a frame's box.
struct Axis {
  float min = 0, max = 0;
};
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
                          "the simulation has failed; use more substeps");
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
    const float error = (axis.max - axis.min) / (2 * steps);
    if (error < finest / 20) continue;
    throw base::Error(place,
                      fmt::format("particles spread over {:.4g} m, which 16 bit resolve to {:.3g} m; radius "
                                  "{:.3g} m needs a twentieth",
                                  axis.max - axis.min, error, finest),
                      "keep the fluid inside the tank, or use a smaller --n-star");
  }
}

/// Indices of the particles by level, within a level as they came.
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

/// Small differences of either sign become small numbers.
std::uint16_t zigzag(std::uint16_t difference) {
  return static_cast<std::uint16_t>((difference << 1) ^ ((difference & 0x8000) ? 0xffff : 0));
}
std::uint16_t unzigzag(std::uint16_t value) {
  return static_cast<std::uint16_t>((value >> 1) ^ ((value & 1) ? 0xffff : 0));
}

/// Planes of one axis: n high bytes, then n low bytes, of the differences along the order.
void encode_axis(const std::vector<RenderParticle>& particles, const std::vector<std::uint32_t>& order,
                 std::size_t axis, const Axis& range, std::uint8_t* planes) {
  const std::size_t n = order.size();
  const double scale = range.max > range.min ? 65535.0 / (double(range.max) - double(range.min)) : 0;
  std::uint16_t before = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double offset = double(coordinate(particles[order[i]], axis)) - double(range.min);
    const auto q = static_cast<std::uint16_t>(std::clamp(std::lround(offset * scale), 0L, 65535L));
    const std::uint16_t code = zigzag(static_cast<std::uint16_t>(q - before));
    planes[i] = static_cast<std::uint8_t>(code >> 8);
    planes[n + i] = static_cast<std::uint8_t>(code & 0xff);
    before = q;
  }
}

/// Adds up the differences of one axis and hands each coordinate to `set`.
template <typename Set>
void decode_axis(const std::uint8_t* planes, std::size_t n, const Axis& range, Set set) {
  const float scale = (range.max - range.min) / steps;
  std::uint16_t q = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto code = static_cast<std::uint16_t>(planes[i] << 8 | planes[n + i]);
    q = static_cast<std::uint16_t>(q + unzigzag(code));
    set(i, range.min + scale * static_cast<float>(q));
  }
}

Box get_box(ByteReader& in) {
  Box box{};
  for (Axis& axis : box) {
    axis.min = in.get<float>();
    axis.max = in.get<float>();
    if (!std::isfinite(axis.min) || !std::isfinite(axis.max) || axis.max < axis.min ||
        !std::isfinite(axis.max - axis.min)) {
      in.fail("has a box that is none");
    }
  }
  return box;
}

}  // namespace

void encode_particles(double time_s, const FrameAccount& account,
                      const std::vector<RenderParticle>& particles,
                      const std::vector<float>& radius_by_level_m, int zstd_level, const std::string& place,
                      Bytes& out) {
  if (particles.size() > static_cast<std::size_t>(max_bake_particles)) {
    throw base::Error(place, "holds more particles than a bake may", "use a smaller --n-star");
  }
  BakeFacts facts{time_s, account};
  const auto order = order_by_level(particles, radius_by_level_m, place, facts.account.particles_by_level);
  const Box box = bounding_box(particles, place);
  check_error(box, radius_by_level_m, place);

  out.clear();
  ByteWriter writer(out);
  put_facts(writer, facts);
  for (const Axis& axis : box) {
    writer.put(axis.min);
    writer.put(axis.max);
  }
  Bytes planes(6 * particles.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    encode_axis(particles, order, axis, box[axis], planes.data() + 2 * axis * particles.size());
  }
  pack(planes, zstd_level, out);
}

void decode_particles(ByteSpan payload, std::uint32_t format, const std::vector<float>& radius_by_level_m,
                      std::int64_t max_particles, const std::string& place, Bytes& scratch, BakeFrame& out) {
  ByteReader in(payload, place);
  out.facts = get_facts(in, format, radius_by_level_m.size());
  const std::int64_t total = out.facts.account.particles();
  if (total > max_particles) in.fail("states " + std::to_string(total) + " particles");
  const Box box = get_box(in);
  const auto n = static_cast<std::size_t>(total);
  unpack(in, 6 * n, scratch);

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
}

}  // namespace sim
