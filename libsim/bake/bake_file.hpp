#pragma once
/// Bake files: the particle frames of a scene, and for a fixed camera its pictures, computed beforehand and
/// played back.
///
/// Layout, little-endian:
///   magic "VIPBAKE\n", u32 format version, u32 header bytes, u64 XXH3 of the header, header,
///   chunks (a particle frame each, and after it that frame's foam when foam is kept, and its picture when
///   there are pictures),
///   index (kind, offset, size and XXH3 of every chunk),
///   footer (index offset, chunk count, XXH3 of the index, content hash, magic "VIPBEND\n").
/// The footer comes last, so a file that was cut short is known as such. Positions are 16 bit per axis over
/// each frame's bounding box: off by at most extent / 131070, which the writer holds under a twentieth of the
/// finest radius; foam's radii and temperatures likewise, each over its range in the frame. All else is
/// exact, each frame's account too (not in format 1). Since format 3 the header tells how the fluid was
/// watched and what tau followed from, since format 4 the effects that were computed, and foam is kept. Since
/// format 5 the particles may have temperatures, and the header tells what was painted and which effects the
/// picture had. What holds none of that is written in format 4. Equal content gives equal bytes (no date is
/// stored).

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libsim/bake/codec.hpp"
#include "libsim/methods/method.hpp"
#include "libsim/ptpe/tolerance_switch.hpp"
#include "libsim/scene/scene.hpp"
#include "stats/ptpe/ptpe.hpp"

namespace sim {

/// How the fluid was watched while it was baked.
struct BakedView {
  /// Of the picture that was drawn, kept or for the method to follow; 0 x 0 = none was.
  int width_px = 0, height_px = 0;
  double camera_angle_deg = 0;             ///< vertical, of that picture, in (0, 180); 0 = none was drawn
  std::optional<double> visual_angle_deg;  ///< that it was taken to fill of the eye's view; none = not known
  std::string renderer;                    ///< what drew it: gl_description()
  /// Where one was taken to look: "middle" of the picture, along the "scene"'s keys, "none": the method
  /// follows none. Empty = not known (formats before 3).
  std::string gaze;
  std::vector<GazeKey> gaze_path;  ///< read as Scene::gaze is; empty = none is followed

  bool drawn() const { return width_px > 0; }
};

/// What temporal acceleration went by.
struct BakedTolerance {
  FrameRate rate;          ///< that tau followed from
  stats::PtpeModel model;  ///< of tau and beta
  std::uint32_t seed = 1;  ///< of the choice of active particles
};

/// What was baked.
struct BakeHeader {
  std::string scene_name;
  std::string scene_sha256;
  std::string scene_text;       ///< the scene file, so that a bake can be drawn without it; at most 1 MiB
  std::string method;           ///< as method_name() gives it
  std::string backend;          ///< that computed it
  std::string program_version;  ///< that wrote it
  std::int64_t n_star = 0;
  std::int64_t max_particles = 0;  ///< no frame holds more
  std::int64_t frame_count = 0;
  double frame_dt_s = 0;  ///< content time between frames
  Vec3d tank_size_m{};
  std::vector<float> radius_by_level_m;
  /// Pictures: 0 x 0 = none. The camera that took them.
  int picture_width_px = 0;
  int picture_height_px = 0;
  std::string camera;  ///< "view" or "overview"; empty without pictures
  BakedView view;
  std::optional<BakedTolerance> tolerance;  ///< none = a method that solves every particle, or not known
  /// The effects that were computed: format_effects(). None = those of scene_text (formats before 4).
  std::optional<std::string> effects = {};
  /// No frame holds more diffuse particles of the effect foam; 0 = none are kept, or a format before 4.
  std::int64_t max_foam = 0;
  /// Of the effect heat, K: what the particles' temperatures count from. None = none are kept, or a format
  /// before 5.
  std::optional<double> reference_k = {};
  /// What was asked to be painted over the water: "temperature", or nothing. Pictures hold it.
  std::string overlay = {};
  /// Effects of the picture: format_picture_effects(). None = those of scene_text, or a format before 5.
  std::optional<std::string> picture_effects = {};

  bool has_pictures() const { return picture_width_px > 0; }
};

/// How large the parts became.
struct BakeSizes {
  std::uint64_t file_bytes = 0;
  std::uint64_t particle_bytes = 0;
  std::uint64_t foam_bytes = 0;
  std::uint64_t picture_bytes = 0;
};

/// Writes next to `path` under a temporary name and renames in finish(). Destroyed before that, it leaves
/// nothing. Errors (a file that exists and may not be overwritten, no rights, a full disk, particles that
/// cannot be quantised) are base::Error.
class BakeWriter {
 public:
  BakeWriter(const std::filesystem::path& path, const BakeHeader& header, bool overwrite = false);
  /// The errors that the constructor would meet at this path, without touching it: ask before long work.
  static void check_target(const std::filesystem::path& path, bool overwrite);
  ~BakeWriter();
  BakeWriter(const BakeWriter&) = delete;
  BakeWriter& operator=(const BakeWriter&) = delete;

  /// The next frame's particles, and the solver's account of it (Simulation::account). temperature_k: of each
  /// particle, above the header's reference_k; due where it states that, and else not taken.
  void add_frame(double time_s, const std::vector<RenderParticle>& particles, const FrameAccount& account,
                 const std::vector<float>& temperature_k = {});
  /// The foam of the frame just added, before its picture; due where the header states max_foam.
  void add_foam(const std::vector<RenderParticle>& foam);
  /// The picture of the frame just added: 4 x width x height bytes, bottom row first; alpha is dropped.
  void add_picture(ByteSpan rgba);
  /// Writes index and footer, syncs, renames. Every frame that the header states must be there.
  BakeSizes finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Reads frames in any order. Opening checks header, index and footer; each chunk is checked when it is read.
/// Errors (not a bake, truncated, damaged, newer) are base::Error that names the file. Reading is const and
/// may go on in several threads at once, each with its own buffers.
class BakeReader {
 public:
  explicit BakeReader(const std::filesystem::path& path);
  /// Of bytes in memory, which must outlive the reader; `name` stands for the file in messages.
  BakeReader(ByteSpan bytes, const std::string& name);
  ~BakeReader();
  BakeReader(const BakeReader&) = delete;
  BakeReader& operator=(const BakeReader&) = delete;

  const BakeHeader& header() const;
  /// XXH3 over the header and all chunk checksums, 16 hexadecimal digits: names the content.
  std::string content_hash() const;
  std::uint64_t file_bytes() const;

  /// Particles of frame `frame`, 0 <= frame < frame_count.
  void read_frame(std::int64_t frame, BakeFrame& out) const;

 private:
  friend class PictureReader;
  struct State;
  std::unique_ptr<State> state_;
};

/// Reads the pictures of a bake; cheapest in ascending order, because a picture may build on the one before
/// (at most 29 of them). Not thread-safe; the BakeReader must outlive it.
class PictureReader {
 public:
  explicit PictureReader(const BakeReader& bake) : bake_(bake) {}
  /// Picture of frame `frame`. Its memory stays valid until the next call.
  const BakePicture& read(std::int64_t frame);

 private:
  void decode(std::int64_t frame);

  const BakeReader& bake_;
  BakePicture picture_, previous_;
  std::int64_t have_ = -1;
  Bytes chunk_, scratch_;
};

/// The format in which a bake with this header is written.
std::uint32_t format_of(const BakeHeader& header);
/// The scene that was baked, with the effects that were computed. base::Error: a scene that cannot be read.
Scene baked_scene(const BakeHeader& header);

/// Header bytes as they stand in a file of the present format.
Bytes format_bake_header(const BakeHeader& header);
/// The inverse, also of earlier formats; base::Error at `place` for anything out of range.
BakeHeader parse_bake_header(ByteSpan bytes, std::uint32_t format, const std::string& place);

}  // namespace sim
