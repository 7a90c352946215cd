#pragma once
/// Screen-space fluid rendering in compute shaders (van der Laan et al. 2009; narrow-range filter of Truong
/// and Yuksel 2018, on nearness = 1 / depth and on pairs of samples). Particles in a GL buffer go in; a
/// picture in any framebuffer and a readable G-buffer come out.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libsim/render/particle_buffer.hpp"
#include "libsim/scene/scene.hpp"
#include "libsim/view/camera.hpp"
#include "libsim/view/gbuffer.hpp"

namespace sim {

/// What may be chosen. Lengths in units of a particle's own radius r where a name ends in _r.
struct RenderOptions {
  /// Splatted radius / particle radius. Touching spheres (1) let the next layer shine through between them.
  float radius_scale = 1.5F;
  /// Walls and floor cut the spheres, so that no water is seen outside the glass. Off: particles that leaked
  /// are drawn where they are.
  bool clip_to_tank = true;
  /// Standard deviation of one round of the depth filter in the world (Truong and Yuksel); n rounds smooth as
  /// one that is sqrt(n) times as wide.
  float filter_sigma_r = 1.1F;
  /// Half-width of the narrow range. Truong and Yuksel use about 10; with r = half a spacing that is five
  /// layers of water and smears droplets over what lies behind them, so the default is two layers. Water that
  /// is seen at a slant is wider in depth; pairs of samples follow it (shaders/narrow_range.glsl).
  float filter_delta_r = 4;
  float filter_mu_r = 1;  ///< what is far behind counts as this far behind
  /// How often the filter goes through both directions (Truong and Yuksel iterate too). One round leaves
  /// streaks: what the last direction meets at a crest stays in its column.
  int filter_rounds = 2;
  /// The filter reaches 3 sigma, but at most this many px; pixels where it had to stop short are counted.
  int filter_max_px = 256;
  /// Samples a side and direction; a wider filter takes strided samples.
  int filter_max_taps = 12;
  /// Thickness at every pixel (1), every second (2) or every fourth (4) each way.
  int thickness_step = 2;
  /// Unit of the fixed-point thickness, m; a pixel saturates at 2^32 - 1 units.
  float thickness_unit_m = 1.0F / 65536;
  /// Share of space that touching spheres of a cubic lattice fill (pi / 6): thickness / packing is the length
  /// of the way through water.
  float packing = 0.5235988F;
  /// Beer-Lambert absorption of red, green and blue, 1/m.
  std::array<float, 3> absorption_per_m{0.45F, 0.14F, 0.10F};
  /// Footprints up to this many px a side are splatted by one invocation; 0: 16 on a GPU, 64 on software GL.
  int thread_px = 0;
  /// Larger ones up to this by a team of 8 x 4; beyond it they are split among many work groups.
  int group_px = 128;
  /// Cells of the maps of the light on the floor along its longer side, with picture effects; 64 to 2048.
  int floor_cells = 512;
  bool time_passes = false;  ///< see FluidRenderer::times(); costs waits on software GL
};

/// What the last draw met, over all its views. Nothing is dropped in silence.
struct RenderCounts {
  std::uint32_t not_finite = 0;      ///< particles skipped: NaN, infinity, or a radius that is not positive
  std::uint32_t outside = 0;         ///< particles that touch no pixel
  std::uint32_t beyond_walls = 0;    ///< particles outside the tank as a whole, not drawn (clip_to_tank)
  std::uint32_t near_crossing = 0;   ///< particles cut by the near plane
  std::uint32_t subpixel = 0;        ///< particles too small to be sure of a pixel centre; drawn as one pixel
  std::uint32_t by_thread = 0;       ///< footprints splatted by one invocation
  std::uint32_t by_group = 0;        ///< footprints splatted by one team of invocations
  std::uint32_t by_tiles = 0;        ///< footprints split among many work groups
  std::uint32_t filter_capped = 0;   ///< pixels whose depth filter stopped at filter_max_px
  std::uint32_t thickness_full = 0;  ///< thickness pixels that saturated
  std::uint32_t front_missing = 0;   ///< fluid pixels without a front particle: 0 unless the driver is broken
};

/// Values to paint over the water, one a particle in the order of the particle buffer.
struct Overlay {
  std::span<const float> values;  ///< NaN is painted magenta
  float low = 0, high = 1;        ///< ends of the scale; finite and low < high
  bool classes = false;           ///< whole numbers 0 to 3, one colour each, instead of a scale
};

/// What picture effects found on the floor: a value a cell, x first, from the tank's low corner; an array is
/// empty where its effect is not there.
struct FloorMap {
  int width = 0, depth = 0;  ///< cells along x and z
  float cell_m = 0;          ///< a cell's edge
  std::vector<float> open;  ///< shadows: share of the sunlight that no obstacle and no flying water keeps off
  std::vector<float> way_m;     ///< shadows: its way through the pool's water
  std::vector<float> gathered;  ///< caustics: brightness over that without water
};

/// Milliseconds of one pass of the last draw, over all its views.
struct PassTime {
  std::string pass;
  double ms = 0;
};

/// The renderer's passes in order, and why those are there that not every scene has. Needs no context.
std::string passes_in_words(const Scene& scene);

/// Needs a current OpenGL 4.5 context at every call and when it is destroyed. Leaves the GL state of a new
/// context except for the viewport. The same particles, views and options give the same picture, bit for bit,
/// on one driver, in whatever order the particles are drawn by the device; of equal depths the lower index is
/// in front.
class FluidRenderer {
 public:
  /// The scene gives the tank, the obstacles and the effects. Errors (base::Error): an option out of range, a
  /// shader that is missing or does not compile.
  explicit FluidRenderer(const Scene& scene, const RenderOptions& options = {});
  ~FluidRenderer();
  FluidRenderer(const FluidRenderer&) = delete;
  FluidRenderer& operator=(const FluidRenderer&) = delete;

  /// The scene's obstacles are drawn where they are at this time since frame 0; at first, where they begin.
  void place_obstacles(double time_s);
  /// Where these say, in the scene's order: Simulation::read_obstacles.
  void place_obstacles(const std::vector<BodyMotion>& motions);

  /// Draws one or two views into `framebuffer` (0 = the window). Writes every pixel of their viewports in
  /// sRGB and nothing outside them. Returns without waiting for the device.
  /// `foam`: diffuse particles, of a scene that lists the effect; others have no pass that would draw them.
  /// Entries without a radius are nobody. The water's G-buffer does not hold them.
  void draw(const ParticleBuffer& particles, std::span<const View> views, unsigned framebuffer,
            const ParticleBuffer* foam = nullptr);

  /// Paints values over the views of the last draw, in the same framebuffer. base::Error when nothing was
  /// drawn or the range is empty.
  void paint(const Overlay& overlay, unsigned framebuffer);

  /// What saliency reads of a view of the last draw, where it lies. base::Error when that view was not drawn.
  GlPicture picture(std::size_t view = 0) const;
  /// The same on the host, in the storage of `out`, whose other arrays are emptied; waits for the device.
  void read_picture(GBuffer& out, std::size_t view = 0) const;
  /// The G-buffer of a view of the last draw; waits for the device. base::Error when that view was not drawn.
  GBuffer read_gbuffer(std::size_t view = 0) const;
  /// Its depth alone (GBuffer::depth).
  std::vector<float> read_depth(std::size_t view = 0) const;
  /// The light on the floor of the last draw, over all its views; waits for the device. base::Error where the
  /// scene lists no picture effect, or nothing was drawn.
  FloorMap read_floor() const;
  /// Waits for the device.
  RenderCounts counts() const;
  /// In order of the passes; empty unless time_passes. Waits for the device.
  std::vector<PassTime> times() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sim
