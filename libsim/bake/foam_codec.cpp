#include <algorithm>
#include <cmath>

#include "libsim/bake/codec.hpp"
#include "libsim/bake/quantise.hpp"

namespace sim {

namespace {

using Fields = std::array<float, 4>;
constexpr std::size_t fields = 4;

Fields fields_of(const RenderParticle& particle) {
  return {particle.x_m, particle.y_m, particle.z_m, particle.radius_m};
}

std::array<bake::Axis, fields> ranges_of(const std::vector<RenderParticle>& foam, const std::string& place) {
  std::array<bake::Axis, fields> out{};
  for (std::size_t i = 0; i < foam.size(); ++i) {
    const Fields values = fields_of(foam[i]);
    for (std::size_t k = 0; k < fields; ++k) {
      if (!std::isfinite(values[k]) || (k == 3 && values[k] <= 0))
        throw base::Error(place, "a foam particle has no finite position or no radius above 0",
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
  bake::put_axes(writer, ranges);
  Bytes planes(2 * fields * foam.size());
  for (std::size_t k = 0; k < fields; ++k) {
    bake::encode_axis(
        foam.size(), [&](std::size_t i) { return fields_of(foam[i])[k]; }, ranges[k],
        planes.data() + 2 * k * foam.size());
  }
  pack(planes, zstd_level, out);
}

void decode_foam(ByteSpan payload, std::int64_t max_foam, const std::string& place, Bytes& scratch,
                 std::vector<RenderParticle>& out) {
  ByteReader in(payload, place);
  const std::size_t n = in.get<std::uint32_t>();
  if (static_cast<std::int64_t>(n) > max_foam) in.fail("states " + std::to_string(n) + " particles of foam");
  const auto ranges = bake::get_axes<fields>(in);
  if (n > 0 && !(ranges[3].min > 0)) in.fail("holds foam without a radius");
  unpack(in, 2 * fields * n, scratch);
  out.resize(n);
  RenderParticle* foam = out.data();
  const auto planes = [&](std::size_t k) { return scratch.data() + 2 * k * n; };
  bake::decode_axis(planes(0), n, ranges[0], [=](std::size_t i, float x) { foam[i].x_m = x; });
  bake::decode_axis(planes(1), n, ranges[1], [=](std::size_t i, float y) { foam[i].y_m = y; });
  bake::decode_axis(planes(2), n, ranges[2], [=](std::size_t i, float z) { foam[i].z_m = z; });
  bake::decode_axis(planes(3), n, ranges[3], [=](std::size_t i, float r) { foam[i].radius_m = r; });
}

}  // namespace sim
