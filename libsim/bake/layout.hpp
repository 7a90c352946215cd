#pragma once
/// The fixed parts of a bake file, shared by writer and reader.

#include <array>
#include <cstdint>
#include <string>

#include "libsim/bake/bytes.hpp"

namespace sim::bake {

inline constexpr std::array<char, 8> magic{'V', 'I', 'P', 'B', 'A', 'K', 'E', '\n'};
inline constexpr std::array<char, 8> end_magic{'V', 'I', 'P', 'B', 'E', 'N', 'D', '\n'};
inline constexpr std::size_t prologue_bytes = 8 + 4 + 4 + 8;
inline constexpr std::size_t footer_bytes = 8 + 8 + 8 + 8 + 8;
inline constexpr std::size_t entry_bytes = 4 + 8 + 8 + 8;
inline constexpr std::size_t max_scene_bytes = 1 << 20;
inline constexpr std::size_t max_header_bytes = max_scene_bytes + (64 << 10);
inline constexpr std::int64_t max_frames = 1 << 20;
/// Every 30th picture is encoded independently, so that a jump decodes at most 30 pictures.
inline constexpr std::int64_t key_interval = 30;

enum class ChunkKind : std::uint32_t { Particles = 1, KeyPicture = 2, Picture = 3, Foam = 4 };

struct IndexEntry {
  ChunkKind kind = ChunkKind::Particles;
  std::uint64_t offset = 0;
  std::uint64_t size = 0;
  std::uint64_t checksum = 0;
};

inline ByteSpan as_bytes(const std::array<char, 8>& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

inline std::string frame_place(const std::string& file, const char* what, std::int64_t frame) {
  return file + ": " + what + " " + std::to_string(frame);
}

}  // namespace sim::bake
