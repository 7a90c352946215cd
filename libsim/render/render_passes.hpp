#pragma once
/// Implementation of a FluidRenderer: its programs and buffers, and the passes of a draw. Internal to the
/// renderer.

#include <epoxy/gl.h>

#include <array>
#include <initializer_list>
#include <optional>
#include <span>

#include "libsim/gl/gl_program.hpp"
#include "libsim/render/floor_light.hpp"
#include "libsim/render/fluid_renderer.hpp"
#include "libsim/render/pass_timer.hpp"
#include "libsim/render/surroundings.hpp"
#include "libsim/render/view_targets.hpp"

namespace sim {

inline constexpr std::size_t most_views = 2;

/// A program with one compute shader.
GlProgram compute_program(const char* file, const char* defines = "");

/// Binds the buffers, given by GL name, to shader storage 0, 1, ...; the name 0 leaves a binding empty.
void bind_storage(std::initializer_list<unsigned> buffers);

/// Starts one invocation per pixel, in groups of 16 x 8, or per particle, in groups of 64.
void dispatch_pixels(int width, int height);
void dispatch_particles(std::int64_t count);
/// Starts one invocation per pixel of the view's tiles with water, or of those without
/// (shaders/wet_tiles.glsl).
void dispatch_tiles(const ViewTargets& view, bool wet);

/// The parts of shaders/obstacles.glsl that the scene needs, as #define lines.
std::string obstacle_defines(const Scene& scene);

struct FluidRenderer::State {
  RenderOptions options;
  std::array<float, 4> tank;
  std::array<float, 4> absorption;  // 1/m; the last one is 1 if the tank has a lid
  PassTimer timer;
  bool foam;  // the scene lists foam: draws one more pass, and compiles foam into the composite
  GlProgram clear_targets = compute_program("clear.comp");
  /// The programs that draw particles of one shape.
  struct Splats {
    GlProgram small, wide, front, front_wide;
  };
  std::array<std::optional<Splats>, 2> splats;  ///< spheres and ellipsoids; compiled when they are needed
  GlProgram wide_dispatch = compute_program("wide_dispatch.comp");
  GlProgram block_depth = compute_program("block_depth.comp");
  GlProgram wet_tiles = compute_program("wet_tiles.comp");
  GlProgram filter_depth = compute_program("filter_depth.comp");
  GlProgram clean_depth = compute_program("clean_depth.comp");
  GlProgram normals = compute_program("normals.comp");
  GlProgram thickness_first = compute_program("smooth_thickness.comp", "#define FIRST\n");
  GlProgram thickness_second = compute_program("smooth_thickness.comp");
  std::unique_ptr<FloorLight> floor_light;  // only with picture effects
  Surroundings surroundings;
  GlProgram composite, composite_dry;
  GlProgram outlines;
  GlProgram edges = compute_program("edges.comp");
  GlProgram splat_foam_program;
  GlProgram overlay{{GL_VERTEX_SHADER, "screen.vert"}, {GL_FRAGMENT_SHADER, "overlay.frag"}};
  GlBuffer counters, no_particles, values;
  std::vector<Obstacle> obstacles;
  std::vector<Pipe> pipes;  // drawn like obstacles
  GlBuffer poses;           // poses of the obstacles; not allocated without obstacles
  GlBuffer grids;           // distance grids of the obstacles that are meshes
  PictureTarget picture;
  GLuint vertex_array = 0;
  std::array<ViewTargets, most_views> targets;
  std::size_t views_drawn = 0;
  std::int64_t particles_drawn = 0;  // over all views

  State(const Scene& scene, const RenderOptions& chosen);
  ~State();

  /// The buffers of a view of the last draw, ready for reading.
  const ViewTargets& drawn(std::size_t view) const;
  /// GBuffer::radius_scale of the last draw. Ellipsoids end a radius before their particle's place.
  float drawn_radius_scale() const { return shapes_ ? 1 : options.radius_scale; }
  void place_obstacles(const std::vector<BodyMotion>& motions);
  void draw_views(const ParticleBuffer& from, std::span<const View> views, unsigned framebuffer,
                  const ParticleBuffer* foam_from);

 private:
  /// Runs a pass: calls `dispatch` for each view with the view's ViewBlock bound, then sets one memory
  /// barrier. The device may process both views at once.
  template <class Dispatch>
  void each_view(Dispatch dispatch, unsigned more_barriers = 0);
  /// The programs for the particles of the present draw, with or without shapes.
  const Splats& splats_of(bool with_shapes);
  void bind_splat(const ViewTargets& t) const;
  void write_block(ViewTargets& t) const;
  void clear();
  void splat_particles();
  void splat_round(int second_round);
  void dispatch_wide(const GlProgram& program, int all_items);
  void find_front();
  void smooth_depth();
  void smooth_thickness();
  void splat_foam(const ParticleBuffer& from);
  /// Sets the number of obstacles and pipes of a program in use.
  void tell_obstacles(const GlProgram& program) const {
    if (solids() > 0) glUniform1i(program.uniform("obstacle_count"), solids());
  }
  void bind_obstacles() const;
  int solids() const { return static_cast<int>(obstacles.size() + pipes.size()); }
  void light_floor();
  void shade();
  void smooth_edges();

  GLuint particles_ = 0;  // GL buffer of the particles of the present draw
  GLuint shapes_ = 0;     // GL buffer of their ellipsoids; 0: spheres
  std::int64_t count_ = 0;
};

template <class Dispatch>
void FluidRenderer::State::each_view(Dispatch dispatch, unsigned more_barriers) {
  for (ViewTargets& t : std::span(targets).first(views_drawn)) {
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, t.block.name());
    dispatch(t);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | more_barriers);
}

}  // namespace sim
