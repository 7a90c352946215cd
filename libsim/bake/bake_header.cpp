#include <cmath>

#include "libsim/bake/bake_file.hpp"
#include "libsim/bake/layout.hpp"

namespace sim {

namespace {

constexpr std::size_t max_text = 4096;

void check(const BakeHeader& header, const ByteReader& in) {
  const auto within = [&](bool good, const std::string& what) {
    if (!good) in.fail("has a header whose " + what + " is out of range");
  };
  within(header.n_star > 0 && header.n_star <= max_bake_particles, "n_*");
  within(header.max_particles >= 0 && header.max_particles <= max_bake_particles, "particle count");
  within(header.frame_count > 0 && header.frame_count <= bake::max_frames, "frame count");
  within(std::isfinite(header.frame_dt_s) && header.frame_dt_s > 0, "time step");
  for (const double side : header.tank_size_m) within(std::isfinite(side) && side > 0, "tank");
  for (const float radius : header.radius_by_level_m) {
    within(std::isfinite(radius) && radius > 0, "radius");
  }
  const auto side = [&](int px) { return px > 0 && px <= max_picture_side; };
  const bool none = header.picture_width_px == 0 && header.picture_height_px == 0;
  within(none || (side(header.picture_width_px) && side(header.picture_height_px)), "picture size");
}

}  // namespace

Bytes format_bake_header(const BakeHeader& header) {
  Bytes bytes;
  ByteWriter out(bytes);
  for (const std::string* text : {&header.scene_name, &header.scene_sha256, &header.method, &header.backend,
                                  &header.program_version, &header.camera}) {
    out.string(*text);
  }
  out.string(header.scene_text);
  out.put(header.n_star);
  out.put(header.max_particles);
  out.put(header.frame_count);
  out.put(header.frame_dt_s);
  for (const double side : header.tank_size_m) out.put(side);
  out.put(static_cast<std::uint32_t>(header.radius_by_level_m.size()));
  for (const float radius : header.radius_by_level_m) out.put(radius);
  out.put(static_cast<std::int32_t>(header.picture_width_px));
  out.put(static_cast<std::int32_t>(header.picture_height_px));
  return bytes;
}

BakeHeader parse_bake_header(ByteSpan bytes, const std::string& place) {
  ByteReader in(bytes, place);
  BakeHeader header;
  for (std::string* text : {&header.scene_name, &header.scene_sha256, &header.method, &header.backend,
                            &header.program_version, &header.camera}) {
    *text = in.string(max_text);
  }
  header.scene_text = in.string(bake::max_scene_bytes);
  header.n_star = in.get<std::int64_t>();
  header.max_particles = in.get<std::int64_t>();
  header.frame_count = in.get<std::int64_t>();
  header.frame_dt_s = in.get<double>();
  for (double& side : header.tank_size_m) side = in.get<double>();
  const auto levels = in.get<std::uint32_t>();
  if (levels == 0 || levels > max_bake_levels) in.fail("states " + std::to_string(levels) + " levels");
  for (std::uint32_t i = 0; i < levels; ++i) header.radius_by_level_m.push_back(in.get<float>());
  header.picture_width_px = in.get<std::int32_t>();
  header.picture_height_px = in.get<std::int32_t>();
  if (!in.rest().empty()) in.fail("has a header of the wrong length");
  check(header, in);
  return header;
}

}  // namespace sim
