#include "libsim/measure/checkpoint_file.hpp"

#include <fmt/core.h>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

#include "libsim/bake/codec.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"

namespace measure {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view magic = "ViP-Lab checkpoint 1\n";  // raise the number if the layout changes
constexpr std::size_t most_file_bytes = std::size_t{4} << 30;
constexpr std::size_t shown_digits = 12;
constexpr int packing = 1;  // zstd level, a fast one; most pixels hold no water and compress well
static_assert(std::is_trivially_copyable_v<sim::ParticleState> && sizeof(sim::ParticleState) == 32);

using Fields = std::vector<std::pair<std::string, std::string>>;
Fields fields_of(const CheckpointOf& of) {
  return {{"scene", of.scene},
          {"scene_sha256", of.scene_sha256},
          {"n_star", std::to_string(of.n_star)},
          {"frame", std::to_string(of.frame)},
          {"picture", base::size_words(of.size)}};
}

[[noreturn]] void damaged(const fs::path& path) {
  throw base::Error(path.string(), "is damaged or cut short", "store it again with --checkpoints-to");
}

sim::ByteSpan bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}
std::string_view text_of(sim::ByteSpan bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string body_of(const Checkpoint& checkpoint, const std::string& place) {
  std::string out(reinterpret_cast<const char*>(checkpoint.state.data()),
                  checkpoint.state.size() * sizeof(sim::ParticleState));
  return out += sim::gbuffer_bytes(checkpoint.seen, place);
}

/// Takes a line "KEY VALUE" from the front of `rest` and returns its value.
std::string take_line(std::string_view& rest, const std::string& key, const fs::path& path) {
  const auto end = rest.find('\n');
  if (end == std::string_view::npos || !rest.starts_with(key + " ")) damaged(path);
  const std::string value(rest.substr(key.size() + 1, end - key.size() - 1));
  rest.remove_prefix(end + 1);
  return value;
}

}  // namespace

std::string checkpoint_name(const CheckpointOf& of) {
  return fmt::format("{}_{}_f{:03}.checkpoint", of.scene, of.n_star, of.frame);
}

std::string checkpoint_digest(const Checkpoint& checkpoint) {
  return base::sha256_hex(body_of(checkpoint, "checkpoint")).substr(0, shown_digits);
}

void write_checkpoint(const fs::path& folder, const CheckpointOf& of, const Checkpoint& checkpoint) {
  const fs::path path = folder / checkpoint_name(of);
  const std::string body = body_of(checkpoint, path.string());
  sim::Bytes packed;
  sim::ByteWriter writer(packed);
  writer.put(static_cast<std::uint64_t>(checkpoint.state.size()));
  writer.put(static_cast<std::uint64_t>(body.size()));
  sim::pack(bytes_of(body), packing, packed);
  std::string out(magic);
  for (const auto& [key, value] : fields_of(of)) out += key + " " + value + "\n";
  out += "sha256 " + base::sha256_hex(text_of(packed)) + "\n";
  base::write_file_atomically(path, out.append(text_of(packed)));
}

Checkpoint read_checkpoint(const fs::path& folder, const CheckpointOf& of) {
  const fs::path path = folder / checkpoint_name(of);
  if (!fs::exists(path)) {
    throw base::Error(path.string(), "does not exist",
                      "store it with --checkpoints-to and the same scene, n_* and checkpoints");
  }
  const std::string bytes = base::read_file(path, most_file_bytes);
  std::string_view rest = bytes;
  if (!rest.starts_with(magic)) {
    throw base::Error(path.string(), "is not a checkpoint that this program reads",
                      "store it again with --checkpoints-to");
  }
  rest.remove_prefix(magic.size());
  for (const auto& [key, value] : fields_of(of)) {
    const std::string its = take_line(rest, key, path);
    if (its == value) continue;
    throw base::Error(path.string(), "has " + key + " " + base::shortened(its) + ", this run has " + value,
                      "use the scene, n_*, checkpoints and --size with which it was stored, or store it "
                      "again with --checkpoints-to");
  }
  const std::string digest = take_line(rest, "sha256", path);
  if (base::sha256_hex(rest) != digest) damaged(path);

  sim::ByteReader reader(bytes_of(rest), path.string());
  const auto particles = reader.get<std::uint64_t>(), size = reader.get<std::uint64_t>();
  if (size > most_file_bytes || particles > size / sizeof(sim::ParticleState)) damaged(path);
  sim::Bytes body;
  sim::unpack(reader, size, body);
  Checkpoint out;
  out.frame = of.frame;
  out.state.resize(particles);
  const std::size_t state_bytes = particles * sizeof(sim::ParticleState);
  if (state_bytes > 0) std::memcpy(out.state.data(), body.data(), state_bytes);
  out.seen = sim::gbuffer_of(text_of(sim::ByteSpan(body).subspan(state_bytes)), path.string());
  return out;
}

}  // namespace measure
