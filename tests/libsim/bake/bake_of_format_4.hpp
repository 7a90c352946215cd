#pragma once
/// A bake (a recorded run) of water without heat that uses every feature of format 4: accounts with tau,
/// effects, foam and pictures. It is so small and noisy that no version of zstd compresses any of it, so its
/// bytes are the same everywhere.

#include "tests/libsim/bake/make_bake.hpp"

namespace bake_test {

inline void write_of_format_4(const std::filesystem::path& path) {
  auto header = bake_test::header(2, 4, 3);
  header.max_foam = 9;
  header.effects = "[[effect]]\nkind = \"foam\"\nemission_per_s = 2\n";
  sim::BakeWriter writer(path, header, true);
  for (std::int64_t i = 0; i < 2; ++i) {
    auto facts = account(i + 1);
    facts.temporal->active = 3;
    writer.add_frame(0.5 * static_cast<double>(i), particles(i, 1, 2, 2), facts);
    writer.add_foam(particles(i, 1, 1, 2));
    std::mt19937 random(static_cast<unsigned>(i));
    sim::Bytes noise(4 * 4 * 3);
    for (auto& byte : noise) byte = static_cast<std::uint8_t>(random());
    writer.add_picture(noise);
  }
  writer.finish();
}

}  // namespace bake_test
