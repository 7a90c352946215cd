#pragma once
/// Chunks of a bake file: particle frames and pictures as compressed bytes. Lossless but for the quantisation
/// of positions and temperatures.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libsim/bake/bytes.hpp"
#include "libsim/simulation.hpp"

namespace sim {

/// What a frame consisted of; stands before the particles and before the picture of a frame.
struct BakeFacts {
  double time_s = 0;     ///< since the gate opened
  FrameAccount account;  ///< one count for each radius of the file's header; files of format 1 hold no more
};

/// The particles of one frame, by level and within a level in the solver's order.
struct BakeFrame {
  BakeFacts facts;
  std::vector<RenderParticle> particles;
  std::vector<RenderParticle> foam;  ///< Simulation::read_foam; empty where the bake keeps none
  /// Of each particle, K above BakeHeader::reference_k; empty where the bake keeps none.
  std::vector<float> temperature_k;
  double temperature_error_k = 0;  ///< that each of them is off by at most
};

/// One picture, bottom row first as OpenGL reads it, 4 bytes a pixel (R, G, B, 255).
struct BakePicture {
  BakeFacts facts;
  Bytes rgba;
};

/// Most particles that a frame of a bake may hold: HiRes at the largest n_*.
inline constexpr std::int64_t max_bake_particles = std::int64_t{32} << 20;
/// Most diffuse particles of the effect foam.
inline constexpr std::int64_t max_bake_foam = std::int64_t{1} << 20;
/// Most levels, and longest side of a picture, px.
inline constexpr std::size_t max_bake_levels = 16;
inline constexpr int max_picture_side = 8192;
/// That a temperature may be off by, K: frames whose temperatures span more than 13,107 K are none.
inline constexpr double max_temperature_error_k = 0.1;

/// Quantises to 16 bit per axis over the frame's own bounding box: an axis of extent e is off by at most
/// e / 131070 (+ float rounding). That must stay below a twentieth of the finest radius; a frame that spreads
/// wider, a particle that is not finite or a radius that is not in `radius_by_level_m` is a base::Error at
/// `place`.
/// The counts of `account` are taken from the particles. temperature_k: of each particle in their order, as
/// 16 bit over the range of this frame's, off by at most a 131070th of it; nullptr keeps none. One that is
/// not finite, or max_temperature_error_k exceeded, is a base::Error.
void encode_particles(double time_s, const FrameAccount& account,
                      const std::vector<RenderParticle>& particles,
                      const std::vector<float>& radius_by_level_m, const std::vector<float>* temperature_k,
                      int zstd_level, const std::string& place, Bytes& out);

/// How the particles of a file are kept.
struct ParticleLayout {
  std::uint32_t format = 0;  ///< of the file
  std::vector<float> radius_by_level_m;
  std::int64_t max_particles = 0;
  bool temperatures = false;
};

/// The inverse. Refuses (base::Error at `place`) counts beyond `max_particles` before it allocates, and data
/// that decode to another size than stated. `scratch` keeps its memory between calls.
void decode_particles(ByteSpan payload, const ParticleLayout& layout, const std::string& place,
                      Bytes& scratch, BakeFrame& out);

/// Foam: place and radius of each, 16 bit over the frame's own range of each.
void encode_foam(const std::vector<RenderParticle>& foam, int zstd_level, const std::string& place,
                 Bytes& out);
/// The inverse. Refuses (base::Error at `place`) counts beyond `max_foam` before it allocates.
void decode_foam(ByteSpan payload, std::int64_t max_foam, const std::string& place, Bytes& scratch,
                 std::vector<RenderParticle>& out);

/// Pictures: colour planes G, R - G, B - G; each row the residual of one of five predictors (none, left,
/// above, gradient, previous picture), then zstd. `previous` is the picture before, or empty for a key
/// picture. Alpha is dropped.
void encode_picture(const BakeFacts& facts, ByteSpan rgba, ByteSpan previous, int width_px, int height_px,
                    int zstd_level, Bytes& out);

/// The inverse, with the same `previous`; it may not overlap out.rgba.
void decode_picture(ByteSpan payload, std::uint32_t format, std::size_t levels, ByteSpan previous,
                    int width_px, int height_px, const std::string& place, Bytes& scratch, BakePicture& out);

/// The newest format; all from 1 on are read. A file that holds nothing of format 5 is written as 4, bit for
/// bit as before there was a 5 (format_of).
inline constexpr std::uint32_t bake_format = 5;

/// Facts as they stand at the front of both kinds of chunk: time and counts, since format 2 then one byte
/// that says what was measured (FactBits), and that: tau, mu and delta, beta and the number of active
/// particles, the guards.
void put_facts(ByteWriter& out, const BakeFacts& facts);
BakeFacts get_facts(ByteReader& in, std::uint32_t format, std::size_t levels);

/// zstd of `data`, or the data as they are when they would shrink by more than 4096 to 1; the first byte says
/// which. unpack() refuses any other size than `size`, and allocates only after the ratio was checked, so
/// that memory stays in proportion to the file.
void pack(ByteSpan data, int zstd_level, Bytes& out);
void unpack(ByteReader& in, std::size_t size, Bytes& out);

}  // namespace sim
