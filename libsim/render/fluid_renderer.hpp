#pragma once
/// Screen-space fluid rendering in compute shaders (van der Laan et al. 2009; narrow-range filter of Truong
/// and Yuksel 2018, here applied to nearness = 1 / depth and to pairs of samples). Input: particles in a GL
/// buffer. Output: a picture in any framebuffer and a readable G-buffer.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libsim/gl/gl_buffer.hpp"
#include "libsim/particles/particle_state.hpp"
#include "libsim/scene/scene.hpp"
#include "libsim/view/camera.hpp"
#include "libsim/view/gbuffer.hpp"

namespace sim {

/// Particles as the renderer's input: a GL shader storage buffer of RenderParticle (x, y, z, radius in m),
/// and optionally one of RenderShape: without shapes they are spheres. Needs a current context at every call
/// and when it is destroyed.
class ParticleBuffer {
 public:
  /// Replaces the contents; grows the buffers if needed. `shapes`: one per particle, or none.
  void upload(std::span<const RenderParticle> particles, std::span<const RenderShape> shapes = {});

  /// Allocates `capacity` particles for a writer on the device (CUDA interop), which may then register gl().
  /// gl() stays the same until reserve() or upload() needs more than capacity(). If the buffer grows, its
  /// contents are lost.
  void reserve(std::int64_t capacity);
  /// The same, for particles with shapes.
  void reserve_with_shapes(std::int64_t capacity);
  /// Sets the number of particles that a writer on the device has stored, at most capacity() (base::Error).
  void set_count(std::int64_t count);

  unsigned gl_name() const { return buffer_.name(); }  ///< 0 before the first reserve or upload
  GlBufferRef gl() const { return buffer_.ref(); }
  unsigned shapes_name() const { return with_shapes_ ? shapes_.name() : 0; }  ///< 0 without shapes
  GlBufferRef shapes() const { return shapes_.ref(); }
  std::int64_t count() const { return count_; }
  std::int64_t capacity() const { return capacity_; }

 private:
  GlBuffer buffer_, shapes_;
  bool with_shapes_ = false;
  std::int64_t count_ = 0;
  std::int64_t capacity_ = 0;
};

/// How particles with known neighbours are drawn.
enum class Surface {
  Ellipsoids,  ///< flattened along the water's surface and stretched along threads (Yu and Turk 2013)
  Spheres
};
/// "ellipsoids" or "spheres".
const char* surface_name(Surface surface);
/// base::Error for another word.
Surface parse_surface(const std::string& word);

/// Options of the renderer. Numbers whose names end in _r are in units of the particle's own radius r.
struct RenderOptions {
  /// Spheres: FluidPicture takes no shapes from the simulation. FluidRenderer::draw always follows its
  /// buffer.
  Surface surface = Surface::Ellipsoids;
  /// Splatted radius / particle radius. Touching spheres (1) show the next layer through the gaps between
  /// them.
  float radius_scale = 1.5F;
  /// Walls, floor and lid cut the spheres, so that no water appears outside the glass. Off: leaked particles
  /// are drawn at their positions.
  bool clip_to_tank = true;
  /// Standard deviation of one round of the depth filter in world space (Truong and Yuksel); n rounds smooth
  /// like one that is sqrt(n) times as wide.
  float filter_sigma_r = 1.1F;
  /// Half-width of the narrow range: the depths around the filtered pixel's depth at which samples count in
  /// full. Truong and Yuksel use about 10. With r = half a spacing, 10 r are five layers of water and smear
  /// droplets over the background; the default is two layers. A surface seen at a slant spans more depth;
  /// pairs of samples extend the range there (shaders/narrow_range.glsl).
  float filter_delta_r = 4;
  /// Samples behind the narrow range count as if they were this far behind the filtered pixel's surface.
  float filter_mu_r = 1;
  /// Number of rounds of the depth filter, each along x and then y (Truong and Yuksel iterate too). After
  /// them, one more round without strides smooths between the strided samples. A single round leaves streaks,
  /// because its pass along y spreads the depth of a wave's crest along the column.
  int filter_rounds = 2;
  /// The filter reaches 3 sigma, but at most this many px; pixels with a truncated filter are counted.
  int filter_max_px = 256;
  /// Largest number of samples per side and direction; a wider filter uses strided samples.
  int filter_max_taps = 12;
  /// Thickness at every pixel (1), every second (2) or every fourth (4) in each direction.
  int thickness_step = 2;
  /// Unit of the fixed-point thickness, m; a pixel saturates at 2^32 - 1 units.
  float thickness_unit_m = 1.0F / 65536;
  /// Share of space that touching spheres fill in a cubic lattice: pi / 6. Drawn spheres have radius_scale
  /// times that radius. So a ray's length in water is thickness / (packing * radius_scale^3).
  float packing = 0.5235988F;
  /// Footprints up to this many px per side are splatted by one invocation; 0: 16 on a GPU, 64 on software
  /// GL, but not more than group_px.
  int thread_px = 0;
  /// Larger footprints up to this many px per side are splatted by a team of 8 x 4 invocations, still larger
  /// footprints by many work groups.
  int group_px = 128;
  /// Cells of the floor map along the tank's longer side, for picture effects; 64 to 2048.
  int floor_cells = 512;
  bool time_passes =
      false;  ///< enables FluidRenderer::times(); slower on software GL, which waits after each pass
};

/// Event counts of the last draw, over all its views. Every dropped particle is counted.
struct RenderCounts {
  std::uint32_t not_finite = 0;      ///< particles skipped: NaN, infinity, or a radius that is not positive
  std::uint32_t outside = 0;         ///< particles that cover no pixel
  std::uint32_t beyond_walls = 0;    ///< particles completely outside the tank, not drawn (clip_to_tank)
  std::uint32_t near_crossing = 0;   ///< particles cut by the near plane
  std::uint32_t subpixel = 0;        ///< particles that may miss every pixel centre; drawn as one pixel
  std::uint32_t by_thread = 0;       ///< footprints splatted by one invocation
  std::uint32_t by_group = 0;        ///< footprints splatted by one team of invocations
  std::uint32_t by_tiles = 0;        ///< footprints split among many work groups
  std::uint32_t filter_capped = 0;   ///< pixels at filter_max_px, counted along x and along y
  std::uint32_t thickness_full = 0;  ///< cells of the thickness grid that saturated
  std::uint32_t front_missing = 0;   ///< fluid pixels without a front particle: 0 unless the driver is faulty
};

/// Values to paint over the water, one per particle in the order of the particle buffer.
struct Overlay {
  std::span<const float> values;  ///< NaN is painted magenta
  float low = 0, high = 1;        ///< limits of the scale; finite and low < high
  bool classes = false;           ///< integers 0 to 3, one colour each, instead of a scale
};

/// Results of picture effects on the floor: a value per cell, x first, from the tank's low corner; an array
/// is empty if its effect is not listed or has the strength 0.
struct FloorMap {
  int width = 0, depth = 0;     ///< cells along x and z
  float cell_m = 0;             ///< a cell's edge
  std::vector<float> open;      ///< shadows: share of the sunlight not blocked by obstacles and flying water
  std::vector<float> way_m;     ///< shadows: path length through the pool's water
  std::vector<float> gathered;  ///< caustics: brightness relative to that without water
};

/// Milliseconds of one pass of the last draw, over all its views.
struct PassTime {
  std::string pass;
  double ms = 0;
};

/// The renderer's passes in order, and why each optional pass runs or does not run. Needs no context.
std::string passes_in_words(const Scene& scene);

/// Draws water. Needs a current OpenGL 4.5 context at every call and when destroyed. Leaves no program,
/// vertex array or texture bound, and blending off. Buffer bindings change; paint() also changes the
/// viewport, the draw framebuffer and the blend function. The same particles, views and options give the same
/// picture, bit for bit, on one driver, in whatever order the device draws the particles; at equal depths the
/// particle with the lower index is in front.
class FluidRenderer {
 public:
  /// The scene gives the tank, the obstacles and the effects. Errors (base::Error): an option or a picture
  /// effect out of range, a picture effect listed twice, a shader that is missing or does not compile.
  explicit FluidRenderer(const Scene& scene, const RenderOptions& options = {});
  ~FluidRenderer();
  FluidRenderer(const FluidRenderer&) = delete;
  FluidRenderer& operator=(const FluidRenderer&) = delete;

  /// Places the scene's obstacles where they are `time_s` seconds after frame 0; free obstacles at their
  /// start. Without a call they are drawn at their start.
  void place_obstacles(double time_s);
  /// Places the obstacles at these poses, in the scene's order (from Simulation::read_obstacles).
  void place_obstacles(const std::vector<BodyMotion>& motions);

  /// Draws one or two views into `framebuffer` (0 = the window). Writes every pixel of their viewports in
  /// sRGB and nothing outside them. Returns without waiting for the device, unless time_passes is set on
  /// software GL. `foam`: diffuse particles, if the scene lists the effect foam; other scenes have no pass to
  /// draw them. Radius 0 marks an unused entry. In the G-buffer foam changes only the normals. base::Error:
  /// no view, more than two, or a view without size or perspective.
  void draw(const ParticleBuffer& particles, std::span<const View> views, unsigned framebuffer,
            const ParticleBuffer* foam = nullptr);

  /// Paints values over the views of the last draw, in the same framebuffer. Does nothing without values.
  /// base::Error if nothing was drawn, or the limits of the scale are not finite or not low < high.
  void paint(const Overlay& overlay, unsigned framebuffer);

  /// The inputs of saliency (depth, normals, radii) from a view of the last draw, in GL buffers. base::Error
  /// if that view was not drawn.
  GlPicture picture(std::size_t view = 0) const;
  /// Copies the inputs of saliency, GBuffer::depth and GBuffer::normal, from a view of the last draw to `out`
  /// on the host, and empties the other arrays of `out`; waits for the device.
  void read_picture(GBuffer& out, std::size_t view = 0) const;
  /// The G-buffer of a view of the last draw; waits for the device. base::Error if that view was not drawn.
  GBuffer read_gbuffer(std::size_t view = 0) const;
  /// Only GBuffer::depth of a view of the last draw.
  std::vector<float> read_depth(std::size_t view = 0) const;
  /// The light on the floor in the last draw, which all views share; waits for the device. base::Error if the
  /// scene lists no picture effect with a strength above 0, or nothing was drawn.
  FloorMap read_floor() const;
  /// Counts of the last draw; waits for the device.
  RenderCounts counts() const;
  /// Times of the last draw's passes, in their order; empty unless time_passes. Waits for the device.
  std::vector<PassTime> times() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sim
