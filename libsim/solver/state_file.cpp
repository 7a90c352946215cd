#include "libsim/solver/state_file.hpp"

#include <cstring>
#include <sstream>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace sim {

namespace {

constexpr std::string_view state_magic = "ViP-Lab state\n";
constexpr std::size_t digest_size = 64;
constexpr std::size_t head_size = state_magic.size() + sizeof(std::int32_t) + 2 * digest_size;
// Largest file: 8 n_* particles of the finest level, each of 250 bytes, with the largest n_*, 4M.
constexpr std::size_t most_bytes = std::size_t{250} * 8 * (4u << 20);

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& problem,
                       const std::string& mend) {
  throw base::Error(path.string(), problem, mend);
}

void add(std::ostream& text, const Readings& r) {
  text << r.alpha << ' ' << static_cast<int>(r.falloff) << ' ' << r.fovea_half_angle_deg << ' '
       << r.image_plane_m << ' ' << static_cast<int>(r.thickness) << ' ' << r.attenuation_per_m << ' '
       << r.calm_out_of_view << r.hide_manifold_behind << r.dimensionless << r.graded_targets
       << r.merge_same_target << r.merge_keeps_steps << r.dimensionless_levels << r.rest_within_frame
       << r.inactive_yield << ' ' << r.manifold_window_px << ' ' << static_cast<int>(r.gradient) << ' '
       << r.temporal_follow << ' ' << r.temporal_period_frames << ' ' << r.speed_floor << ' '
       << r.density_floor << ' ' << static_cast<int>(r.normalisation) << ' ' << r.saliency_floor << ' '
       << r.drop_density << ' ' << r.gaze_hold_s << ' ' << r.split_offset[0] << ' ' << r.split_offset[1]
       << ' ' << r.split_offset[2] << ' ' << r.split_share << ' ' << r.merge_reach << ' ' << r.merge_overlap
       << ' ' << r.merge_dead_band << ' ' << r.kick_filter << ' ' << r.change_cell_spacings << ' '
       << r.levels_period_frames << ' ' << r.saccade_deg << ' ' << r.saccade_frames << ' ' << r.calm_speed
       << ' ' << r.calm_floor << ' ' << r.calm_dead_band << ' ' << r.calm_viscosity << '\n';
}

/// Adds the scene's hash. A scene that was not read from a file has no hash, so this adds also the scene's
/// values that influence a run, except recirculation_corner_m.
void add(std::ostream& text, const Scene& s) {
  text << s.sha256 << ' ' << s.gravity_m_s2.size() << ' ' << s.frame_dt_s << ' ' << s.v_ref_m_s << ' '
       << s.solver_iterations << ' ' << s.min_substeps << ' ' << s.courant << ' ' << s.viscosity_m2_s;
  const auto add_place = [&](const Vec3d& v) { text << ' ' << v[0] << ' ' << v[1] << ' ' << v[2]; };
  add_place(s.tank_size_m);
  if (s.gravity_m_s2.up() != Gravity().up()) add_place(s.gravity_m_s2.along);
  if (s.lid) text << " lid";
  for (const WaterBlock& block : s.water) {
    add_place(block.min_m);
    add_place(block.max_m);
  }
  for (const Nozzle& n : s.nozzles)
    text << " nozzle " << n.diameter_m << ' ' << n.position_m[0] << ' ' << n.position_m[1] << ' '
         << n.position_m[2] << ' ' << n.speed_m_s << ' ' << n.on_frames << ' ' << n.off_frames << ' '
         << n.temperature_k;
  for (const WarmBox& w : s.warm) {
    text << " warm " << w.temperature_k;
    for (std::size_t k = 0; k < 3; ++k) text << ' ' << w.min_m[k] << ' ' << w.max_m[k];
  }
  for (const Outlet& o : s.outlets)
    text << " outlet " << static_cast<int>(o.wall) << ' ' << o.min_m[0] << ' ' << o.min_m[1] << ' '
         << o.max_m[0] << ' ' << o.max_m[1];
  for (const Effect& e : s.effects)
    text << " effect " << traits_of(e.kind).word << ' ' << e.coefficient << options_in_words(e);
  text << obstacles_in_words(s.obstacles);
  if (s.central_force) {
    const CentralForce& f = *s.central_force;
    text << " force " << f.omega_per_s;
    for (std::size_t k = 0; k < 3; ++k) text << ' ' << f.centre_m[k] << ' ' << f.axis[k];
  }
  text << '\n';
}

}  // namespace

std::string run_key(const Scene& scene, const SimulationOptions& o) {
  std::ostringstream text;
  text << std::hexfloat << method_name(o.method) << ' ' << o.n_star << ' ' << static_cast<int>(o.backend)
       << ' ' << o.saliency_parts << o.forced_targets.has_value() << o.wall_impulse
       << (!o.gauges.empty() || !o.obstacle_gauges.empty()) << o.temporal.always << stays_off(o.temporal)
       << ' ' << o.particle_capacity << ' ' << o.levels << ' ' << o.temporal.seed << in_words(o) << '\n';
  add(text, o.readings);
  add(text, scene);
  return base::sha256_hex(text.str());
}

void write_state_file(const std::filesystem::path& path, std::string_view key, std::string_view body) {
  std::string bytes;
  bytes.reserve(head_size + body.size());
  bytes.append(state_magic);
  const std::int32_t format = state_file_format;
  bytes.append(reinterpret_cast<const char*>(&format), sizeof format);
  bytes.append(key).append(base::sha256_hex(body)).append(body);
  base::write_file_atomically(path, bytes);
}

std::string read_state_file(const std::filesystem::path& path, std::string_view key) {
  std::string bytes = base::read_file(path, most_bytes);
  const std::string_view all = bytes;
  if (!all.starts_with(state_magic))
    fail(path, "is not a state of the solver", "give a file that --save-state wrote");
  if (all.size() < head_size) {
    fail(path,
         "is cut short: it has " + std::to_string(all.size()) + " bytes, fewer than the " +
             std::to_string(head_size) + " bytes of a state's head",
         "save the state again");
  }
  std::int32_t format = 0;
  std::memcpy(&format, all.data() + state_magic.size(), sizeof format);
  if (format != state_file_format) {
    fail(path,
         "has format " + std::to_string(format) + ", this program reads " + std::to_string(state_file_format),
         "resume with the program that saved it");
  }
  const std::size_t key_at = state_magic.size() + sizeof format;
  const std::string_view body = all.substr(head_size);
  if (base::sha256_hex(body) != all.substr(key_at + digest_size, digest_size))
    fail(path, "is damaged or cut short", "save the state again");
  if (all.substr(key_at, digest_size) != key) {
    fail(path, "belongs to a run with another scene, method, n_* or back end, or other numbers of the solver",
         "resume with the scene and the options that the state was saved with");
  }
  return bytes.erase(0, head_size);
}

}  // namespace sim
