#include "libsim/solver/settled_state.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace sim {

namespace fs = std::filesystem;

namespace {

constexpr const char* suffix = ".settled";
constexpr std::size_t digest_size = 64;
/// SHA-256 of the libraries that settle a fluid; libsim/CMakeLists.txt writes it.
constexpr const char* solver_digest =
#include "solver_digest.inc"
    ;
// Largest file: the digest and 8 n_* particles of the finest level, each of 32 bytes, with the largest n_*,
// 4M.
constexpr std::size_t most_bytes = std::size_t{32} * 8 * (4u << 20) + digest_size;
constexpr std::chrono::hours forgotten_after{30 * 24};
static_assert(std::is_trivially_copyable_v<ParticleState> && sizeof(ParticleState) == 32);

/// True if all numbers are finite, the ids are 0, 1, 2, ... and the levels exist; if false, the water is
/// settled again. The file's hash detects damage of the file, but not a state that was wrong when it was
/// written.
bool is_sound(const std::vector<ParticleState>& state) {
  int id = 0;
  return std::all_of(state.begin(), state.end(), [&](const ParticleState& p) {
    const bool finite = std::isfinite(p.x_m) && std::isfinite(p.y_m) && std::isfinite(p.z_m) &&
                        std::isfinite(p.vx_m_s) && std::isfinite(p.vy_m_s) && std::isfinite(p.vz_m_s);
    return finite && p.id == id++ && p.level >= 0 && p.level < most_levels;
  });
}

fs::path file_of(const fs::path& folder, const std::string& key) { return folder / (key + suffix); }

void forget_old(const fs::path& folder) {
  const auto now = fs::file_time_type::clock::now();
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().extension() != suffix) continue;
    const auto written = entry.last_write_time(ignored);
    if (!ignored && now - written > forgotten_after) fs::remove(entry.path(), ignored);
  }
}

}  // namespace

fs::path default_cache_folder() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return fs::path(value ? value : "");
  };
  if (std::getenv("VIP_CACHE_DIR")) return variable("VIP_CACHE_DIR");
  if (const auto cache = variable("XDG_CACHE_HOME"); cache.is_absolute()) return cache / "vip-lab";
  if (const auto home = variable("HOME"); home.is_absolute()) return home / ".cache" / "vip-lab";
  return {};
}

std::string settled_key(const Scene& scene, const SimulationOptions& options) {
  std::ostringstream text;
  text << std::hexfloat << solver_digest << ' ' << scene.sha256 << ' ' << method_name(options.method) << ' '
       << options.n_star << ' ' << backend_name(options.backend) << in_words(options) << ' '
       << format_effects(scene.effects);
  return base::sha256_hex(text.str());
}

std::optional<std::vector<ParticleState>> read_settled(const fs::path& folder, const std::string& key) {
  const fs::path path = file_of(folder, key);
  try {
    if (folder.empty() || !fs::exists(path)) return {};
    const std::string bytes = base::read_file(path, most_bytes);
    if (bytes.size() <= digest_size || (bytes.size() - digest_size) % sizeof(ParticleState) != 0) return {};
    const std::string_view body = std::string_view(bytes).substr(digest_size);
    if (base::sha256_hex(body) != bytes.substr(0, digest_size)) return {};
    std::vector<ParticleState> out(body.size() / sizeof(ParticleState));
    std::memcpy(out.data(), body.data(), body.size());
    if (!is_sound(out)) return {};
    fs::last_write_time(path, fs::file_time_type::clock::now());
    return out;
  } catch (const base::Error&) {
    return {};
  } catch (const fs::filesystem_error&) {
    return {};
  }
}

void write_settled(const fs::path& folder, const std::string& key, const std::vector<ParticleState>& state) {
  if (folder.empty() || !is_sound(state)) return;
  try {
    fs::create_directories(folder);
    const std::string_view body(reinterpret_cast<const char*>(state.data()),
                                state.size() * sizeof(ParticleState));
    base::write_file_atomically(file_of(folder, key), base::sha256_hex(body).append(body));
    forget_old(folder);
  } catch (const base::Error&) {
  } catch (const fs::filesystem_error&) {
  }
}

}  // namespace sim
