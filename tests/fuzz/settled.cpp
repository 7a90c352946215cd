/// Any bytes as a settled state (a cache file of the particles of a scene whose water has settled), with and
/// without the right checksum: the result is nothing, or particles with only finite numbers.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "libsim/solver/settled_state.hpp"
#include "stats/base/file.hpp"
#include "tests/common/temporary_folder.hpp"

namespace {

void read(const std::filesystem::path& folder, const std::string& bytes) {
  if (std::FILE* out = std::fopen((folder / "fuzz.settled").c_str(), "wb")) {
    std::fwrite(bytes.data(), 1, bytes.size(), out);
    std::fclose(out);
  }
  const auto state = sim::read_settled(folder, "fuzz");
  if (!state) return;
  for (const sim::ParticleState& particle : *state) {
    for (const float value :
         {particle.x_m, particle.y_m, particle.z_m, particle.vx_m_s, particle.vy_m_s, particle.vz_m_s})
      if (!std::isfinite(value)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const test::TemporaryFolder folder;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  read(folder.path(), bytes);
  read(folder.path(), base::sha256_hex(bytes) + bytes);
  return 0;
}
