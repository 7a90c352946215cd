/// Any bytes as a bake file: the whole file, and its parts without the checksums that detect most damage.

#include <cstdint>

#include "libsim/bake/bake_file.hpp"
#include "tests/fuzz/attempt.hpp"

namespace {

using fuzz::attempt;

void read_file(sim::ByteSpan bytes) {
  const sim::BakeReader bake(bytes, "fuzz");
  sim::PictureReader pictures(bake);
  sim::BakeFrame frame;
  for (std::int64_t i = 0; i < bake.header().frame_count; ++i) {
    attempt([&] { bake.read_frame(i, frame); });
    if (bake.header().has_pictures()) attempt([&] { pictures.read(i); });
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const sim::ByteSpan bytes(data, size);
  static const sim::Bytes previous(4 * 32 * 18, 99);
  sim::Bytes scratch;
  sim::BakeFrame frame;
  sim::BakePicture picture;
  attempt([&] { read_file(bytes); });
  for (const std::uint32_t format : {1u, 2u, 3u, 4u, 5u}) {
    attempt([&] { sim::parse_bake_header(bytes, format, "fuzz"); });
    const sim::ParticleLayout layout{format, {0.05F, 0.1F}, 1 << 20, format >= 5};
    attempt([&] { sim::decode_particles(bytes, layout, "fuzz", scratch, frame); });
    attempt([&] { sim::decode_picture(bytes, format, 2, {}, 32, 18, "fuzz", scratch, picture); });
    attempt([&] { sim::decode_picture(bytes, format, 2, previous, 32, 18, "fuzz", scratch, picture); });
  }
  attempt([&] { sim::decode_foam(bytes, 1 << 20, "fuzz", scratch, frame.foam); });
  return 0;
}
