#pragma once
/// Bake files: precomputed particle frames of a scene, and its pictures for a fixed camera, for playback.
///
/// Layout, little-endian:
///   magic "VIPBAKE\n", u32 format version, u32 header bytes, u64 XXH3 of the header, header,
///   chunks (one particle frame each, followed by that frame's foam if the bake stores foam, and by its
///   picture if it stores pictures),
///   index (kind, offset, size and XXH3 of every chunk),
///   footer (index offset, chunk count, XXH3 of the index, content hash, magic "VIPBEND\n").
/// The footer is written last, so that a truncated file is detected. Positions have 16 bit per axis over each
/// frame's bounding box: the error is at most extent / 131070; for water the writer keeps it below a
/// twentieth of the finest radius. The radii of foam particles and the temperatures of water particles are
/// stored with 16 bit too, each over its range in the frame. All other values are exact. Each frame has its
/// account (FrameAccount: particle counts, temporal acceleration, guard counts); format 1 stores only the
/// particle counts. Since format 3 the header contains the view (BakedView) and the inputs of temporal
/// acceleration (BakedTolerance). Since format 4 it contains the computed effects, and foam is stored. Since
/// format 5 particles may have temperatures, and the header contains the overlay and the picture's effects.
/// Since format 6 it may contain the surface of the pictures. A bake is written in the lowest of the formats
/// 4 to 6 that holds its contents. Equal content gives equal bytes (no date is stored).

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

/// The picture and the gaze for which the fluid was computed during the bake.
struct BakedView {
  /// Size of the picture that was drawn in each frame, to be stored or only because the method computes
  /// saliency from it; 0 x 0 = no picture was drawn.
  int width_px = 0, height_px = 0;
  /// Vertical angle of the picture's camera, in (0, 180); 0 = no picture was drawn.
  double camera_angle_deg = 0;
  /// Assumed vertical angle between the edges of the shown picture at the participant's eye; none = unknown.
  std::optional<double> visual_angle_deg;
  std::string renderer;  ///< renderer of the picture: gl_description()
  /// Assumed gaze: "middle" (of the picture), "scene" (the scene's gaze keys) or "none" (the method follows
  /// no gaze). Empty = unknown (formats before 3).
  std::string gaze;
  std::vector<GazeKey> gaze_path;  ///< frames and points of the gaze, see GazeKey; empty = no path
  /// How the picture's particles were drawn, surface_name(). Empty = not recorded, or a format before 6.
  std::string surface = {};

  bool drawn() const { return width_px > 0; }
};

/// Inputs of temporal acceleration, which solves only a random part of the particles in each frame. From them
/// follow the tolerance tau, frames/s, and beta, the lowest probability that a particle is solved.
struct BakedTolerance {
  FrameRate rate;          ///< the frame rate from which tau was computed
  stats::PtpeModel model;  ///< the PTPE model that gives tau and beta
  std::uint32_t seed = 1;  ///< for the random choice of active particles
};

/// Describes the contents of a bake.
struct BakeHeader {
  std::string scene_name;
  std::string scene_sha256;
  std::string scene_text;       ///< the scene file, so that the bake can be drawn without it; at most 1 MiB
  std::string method;           ///< as returned by method_name()
  std::string backend;          ///< name of the back end that computed the bake
  std::string program_version;  ///< of the program that wrote the bake
  std::int64_t n_star = 0;
  std::int64_t max_particles = 0;  ///< upper bound on the particles of a frame
  std::int64_t frame_count = 0;
  double frame_dt_s = 0;  ///< simulated time between frames
  Vec3d tank_size_m{};
  std::vector<float> radius_by_level_m;
  /// Size of the pictures, 0 x 0 = none, and the camera that took them.
  int picture_width_px = 0;
  int picture_height_px = 0;
  std::string camera;  ///< "view" or "overview"; empty without pictures
  BakedView view;
  std::optional<BakedTolerance> tolerance;  ///< none = the method solves every particle, or it is unknown
  /// The effects that were computed, as format_effects() writes them. None = those of scene_text (formats
  /// before 4).
  std::optional<std::string> effects = {};
  /// Upper bound on a frame's diffuse particles of the effect foam; 0 = not stored, or a format before 4.
  std::int64_t max_foam = 0;
  /// Reference of the particles' temperatures (effect heat), K. None = not stored, or a format before 5.
  std::optional<double> reference_k = {};
  /// Overlay that colours the water in the pictures: "temperature", or empty for none.
  std::string overlay = {};
  /// Effects of the picture, as format_picture_effects() writes them. None = those of scene_text, or a format
  /// before 5.
  std::optional<std::string> picture_effects = {};

  bool has_pictures() const { return picture_width_px > 0; }
};

/// Sizes of a bake file and of its parts.
struct BakeSizes {
  std::uint64_t file_bytes = 0;
  std::uint64_t particle_bytes = 0;
  std::uint64_t foam_bytes = 0;
  std::uint64_t picture_bytes = 0;
};

/// Writes a bake file under a temporary name next to `path`; finish() renames it. A writer destroyed before
/// that leaves no file. Errors from outside (an existing file that may not be overwritten, no permission, a
/// full disk, a header or particles beyond the format's limits) are base::Error; calls in a wrong order are
/// std::logic_error.
class BakeWriter {
 public:
  BakeWriter(const std::filesystem::path& path, const BakeHeader& header, bool overwrite = false);
  /// Throws the errors that the constructor would throw for this path, without changing any file; to be
  /// called before long work.
  static void check_target(const std::filesystem::path& path, bool overwrite);
  ~BakeWriter();
  BakeWriter(const BakeWriter&) = delete;
  BakeWriter& operator=(const BakeWriter&) = delete;

  /// Adds the next frame: its particles, and the solver's account of it (Simulation::account: particle
  /// counts, temporal acceleration, guard counts). temperature_k: per particle, K above the header's
  /// reference_k; required if the header has reference_k, otherwise it must be empty.
  void add_frame(double time_s, const std::vector<RenderParticle>& particles, const FrameAccount& account,
                 const std::vector<float>& temperature_k = {});
  /// Adds the foam of the last added frame, before its picture; required if the header's max_foam is above 0.
  void add_foam(const std::vector<RenderParticle>& foam);
  /// Adds the picture of the last added frame: 4 x width x height bytes, bottom row first; alpha is dropped.
  void add_picture(ByteSpan rgba);
  /// Writes index and footer, syncs, and renames the file. All frames stated in the header must have been
  /// added.
  BakeSizes finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Reads frames in any order. Opening checks header, index and footer; each chunk is checked when it is read.
/// Errors (not a bake, truncated, damaged, newer) are base::Error that names the file. Reading is const and
/// may run in several threads at once, each with its own buffers.
class BakeReader {
 public:
  explicit BakeReader(const std::filesystem::path& path);
  /// Reads bytes in memory, which must outlive the reader; `name` replaces the file name in messages.
  BakeReader(ByteSpan bytes, const std::string& name);
  ~BakeReader();
  BakeReader(const BakeReader&) = delete;
  BakeReader& operator=(const BakeReader&) = delete;

  const BakeHeader& header() const;
  /// XXH3 over the header and all chunk checksums, 16 hexadecimal digits: identifies the content.
  std::string content_hash() const;
  std::uint64_t file_bytes() const;

  /// Particles, temperatures and foam of frame `frame`, 0 <= frame < frame_count.
  void read_frame(std::int64_t frame, BakeFrame& out) const;

 private:
  friend class PictureReader;
  struct State;
  std::unique_ptr<State> state_;
};

/// Reads the pictures of a bake; fastest in ascending order, because a picture may be encoded relative to the
/// previous one (at most 29 in a row). Not thread-safe; the BakeReader must outlive it.
class PictureReader {
 public:
  explicit PictureReader(const BakeReader& bake) : bake_(bake) {}
  /// Picture of frame `frame`, valid until the next call.
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
/// The baked scene, with the effects that were computed and drawn. base::Error: a scene that cannot be read.
Scene baked_scene(const BakeHeader& header);

/// The header as bytes, in the format that format_of() gives.
Bytes format_bake_header(const BakeHeader& header);
/// Reads header bytes of this or an earlier format; base::Error at `place` for a value out of range, and for
/// too few or too many bytes.
BakeHeader parse_bake_header(ByteSpan bytes, std::uint32_t format, const std::string& place);

}  // namespace sim
