#pragma once
/// Chunks of a bake file: particle frames and pictures as compressed bytes. Lossless except for the
/// quantisation of positions, temperatures and radii of foam.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libsim/bake/bytes.hpp"
#include "libsim/simulation.hpp"

namespace sim {

/// Facts of a frame, stored at the front of its particle chunk and of its picture chunk.
struct BakeFacts {
  double time_s = 0;  ///< simulated time since frame 0
  /// Particle counts (one per radius of the file's header), temporal acceleration and guard counts; format 1
  /// stores only the particle counts.
  FrameAccount account;
};

/// The particles of one frame, ordered by level, and within a level in the solver's order.
struct BakeFrame {
  BakeFacts facts;
  std::vector<RenderParticle> particles;
  std::vector<RenderParticle> foam;  ///< Simulation::read_foam; empty if the bake stores none
  /// Per particle, K above BakeHeader::reference_k; empty if the bake stores none.
  std::vector<float> temperature_k;
  double temperature_error_k = 0;  ///< upper bound on the error of temperature_k, without float rounding
};

/// A picture, bottom row first as in OpenGL, 4 bytes per pixel (R, G, B, 255).
struct BakePicture {
  BakeFacts facts;
  Bytes rgba;
};

/// Upper bound on the particles of a frame: 8 n_* for the largest n_* (number of particles if all are
/// coarsest) that parse_n_star() accepts, when all particles are finest.
inline constexpr std::int64_t max_bake_particles = std::int64_t{32} << 20;
/// Upper bound on the diffuse particles of the effect foam.
inline constexpr std::int64_t max_bake_foam = std::int64_t{1} << 20;
/// Upper bounds on the number of levels (radii of particles), and on a side of a picture in px.
inline constexpr std::size_t max_bake_levels = 16;
inline constexpr int max_picture_side = 8192;
/// Upper bound on the error of a temperature, K: frames whose temperatures span more than 13,107 K are
/// refused.
inline constexpr double max_temperature_error_k = 0.1;

/// Quantises to 16 bit per axis over the frame's bounding box: an axis of extent e has an error of at most e
/// / 131070 (+ float rounding). This error must stay below a twentieth of the finest radius. base::Error at
/// `place`: a frame with a larger extent, a particle that is not finite, a radius that is not in
/// `radius_by_level_m`, or more than max_bake_particles. The counts of `account` are recomputed from the
/// particles. temperature_k: per particle, in their order, as 16 bit over this frame's range, with an error
/// of at most 1 / 131070 of the range; nullptr stores none. base::Error if one is not finite, or
/// max_temperature_error_k is exceeded.
void encode_particles(double time_s, const FrameAccount& account,
                      const std::vector<RenderParticle>& particles,
                      const std::vector<float>& radius_by_level_m, const std::vector<float>* temperature_k,
                      int zstd_level, const std::string& place, Bytes& out);

/// The properties of a bake file that are needed to decode its particles.
struct ParticleLayout {
  std::uint32_t format = 0;  ///< format of the file
  std::vector<float> radius_by_level_m;
  std::int64_t max_particles = 0;
  bool temperatures = false;
};

/// Decodes the bytes of encode_particles(). Refuses (base::Error at `place`) counts beyond `max_particles`
/// before it allocates, and data that decode to another size than the counts require. `scratch` is reused
/// between calls.
void decode_particles(ByteSpan payload, const ParticleLayout& layout, const std::string& place,
                      Bytes& scratch, BakeFrame& out);

/// Encodes foam: position and radius of each particle, each value with 16 bit over its range in the frame.
/// base::Error at `place` for a value that is not finite, or a radius that is not above 0.
void encode_foam(const std::vector<RenderParticle>& foam, int zstd_level, const std::string& place,
                 Bytes& out);
/// Decodes the bytes of encode_foam(). Refuses (base::Error at `place`) counts beyond `max_foam` before it
/// allocates.
void decode_foam(ByteSpan payload, std::int64_t max_foam, const std::string& place, Bytes& scratch,
                 std::vector<RenderParticle>& out);

/// Encodes a picture: colour planes G, R - G, B - G; each row is the residual of one of five predictors
/// (none, left, above, gradient, previous picture), then zstd. `previous` is the previous picture, or empty
/// for a key picture. Alpha is dropped.
void encode_picture(const BakeFacts& facts, ByteSpan rgba, ByteSpan previous, int width_px, int height_px,
                    int zstd_level, Bytes& out);

/// Decodes the bytes of encode_picture(). `previous`: as passed to encode_picture(); may not overlap
/// out.rgba.
void decode_picture(ByteSpan payload, std::uint32_t format, std::size_t levels, ByteSpan previous,
                    int width_px, int height_px, const std::string& place, Bytes& scratch, BakePicture& out);

/// The newest format; all formats from 1 on can be read. A file without contents of the formats 5 and 6 is
/// written as format 4, bit for bit as before they existed (format_of).
inline constexpr std::uint32_t bake_format = 6;

/// Writes and reads the facts at the front of particle and picture chunks: time and counts; since format 2
/// one byte that says which of the following were measured (FactBits in codec.cpp), then these: the tolerance
/// tau, mean and standard deviation of the frame rate, beta and the number of solved particles, and the guard
/// counts.
void put_facts(ByteWriter& out, const BakeFacts& facts);
BakeFacts get_facts(ByteReader& in, std::uint32_t format, std::size_t levels);

/// pack() appends a byte that says whether the data are compressed, then `data` compressed by zstd. It
/// appends `data` uncompressed if zstd does not make them smaller, or makes them 4096 times smaller or more.
/// unpack() refuses data of any size other than `size`. It allocates memory only after checking this ratio,
/// so that memory stays proportional to the file.
void pack(ByteSpan data, int zstd_level, Bytes& out);
void unpack(ByteReader& in, std::size_t size, Bytes& out);

}  // namespace sim
