#include "libsim/render/fluid_renderer.hpp"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "libsim/render/gl_context.hpp"
#include "libsim/render/gl_program.hpp"
#include "libsim/render/pass_timer.hpp"
#include "libsim/render/view_targets.hpp"
#include "stats/base/error.hpp"

namespace sim {

namespace {

constexpr std::size_t max_views = 2;
constexpr std::uint32_t infinity_bits = 0x7f800000u;
constexpr std::int64_t list_header_words = 12;
constexpr int block_px = 16;  // of occlusion.glsl
constexpr GLuint tile_groups = 64;

/// std140 layout of the shaders' ViewBlock.
struct ViewBlock {
  Mat4 world_to_eye, eye_to_world;
  std::array<float, 4> rays;
  std::array<std::int32_t, 4> size;
  std::array<float, 4> origin, narrow_range, thickness_rule, absorption, tank;
};

void check(bool good, const char* what, const char* mend) {
  if (!good) throw base::Error("render options", what, mend);
}

void check_options(const RenderOptions& o) {
  const auto positive = [](float value) { return std::isfinite(value) && value > 0; };
  check(positive(o.radius_scale), "radius_scale must be positive", "use about 1.5");
  check(positive(o.filter_sigma_r) && positive(o.filter_delta_r) && positive(o.filter_mu_r),
        "the filter's sigma, delta and mu must be positive", "use about 1.1, 4 and 1");
  check(o.filter_max_px >= 1 && o.filter_max_taps >= 1, "the filter needs at least one sample and one px",
        "use about 256 px and 12 samples");
  check(o.filter_rounds >= 1 && o.filter_rounds <= 8, "filter_rounds must be 1 to 8", "use 2");
  check(o.thickness_step == 1 || o.thickness_step == 2, "thickness_step must be 1 or 2", "use 2");
  check(positive(o.thickness_unit_m) && positive(o.packing), "thickness unit and packing must be positive",
        "use 1/65536 m and pi/6");
  check(o.thread_px >= 0 && o.group_px >= std::max(o.thread_px, 1),
        "footprint limits must be 0 <= thread_px <= group_px", "use 0 and 128");
}

std::array<float, 4> pack(const PixelRays& rays) {
  return {rays.scale_x, rays.offset_x, rays.scale_y, rays.offset_y};
}

void check_view(const View& view) {
  const auto finite = [](const Mat4& m) {
    return std::all_of(m.begin(), m.end(), [](float v) { return std::isfinite(v); });
  };
  if (view.viewport.width < 1 || view.viewport.height < 1 || !finite(view.view) || !finite(view.projection) ||
      view.projection[0] == 0 || view.projection[5] == 0 || !(view.near_m > 0)) {
    throw base::Error("view",
                      "an empty viewport, a matrix that is not finite, or a near plane at or behind the eye",
                      "give each view a viewport of at least 1 x 1 px and a perspective projection");
  }
}

void bind(std::initializer_list<unsigned> buffers) {
  GLuint binding = 0;
  for (const unsigned buffer : buffers) {
    if (buffer) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer);
    ++binding;
  }
}

void dispatch_pixels(int width, int height) {
  glDispatchCompute(static_cast<GLuint>(width + 15) / 16, static_cast<GLuint>(height + 7) / 8, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void dispatch_particles(std::int64_t count) {
  const std::int64_t groups = (count + 63) / 64;
  const std::int64_t across = std::min<std::int64_t>(groups, 32768);
  glDispatchCompute(static_cast<GLuint>(across), static_cast<GLuint>((groups + across - 1) / across), 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

GlProgram compute(const char* file, const char* defines = "") {
  return GlProgram({{GL_COMPUTE_SHADER, file}}, defines);
}

}  // namespace

struct FluidRenderer::State {
  RenderOptions options;
  std::array<float, 4> tank;
  PassTimer timer;
  GlProgram splat = compute("splat.comp");
  GlProgram wide_dispatch = compute("wide_dispatch.comp");
  GlProgram block_depth = compute("block_depth.comp");
  GlProgram splat_wide = compute("splat_wide.comp");
  GlProgram front = compute("front.comp");
  GlProgram front_wide = compute("splat_wide.comp", "#define FRONT\n");
  GlProgram filter_depth = compute("filter_depth.comp");
  GlProgram clean_depth = compute("clean_depth.comp");
  GlProgram normals = compute("normals.comp");
  GlProgram thickness_first = compute("smooth_thickness.comp", "#define FIRST\n");
  GlProgram thickness_second = compute("smooth_thickness.comp");
  GlProgram composite{{GL_VERTEX_SHADER, "screen.vert"}, {GL_FRAGMENT_SHADER, "composite.frag"}};
  GlProgram overlay{{GL_VERTEX_SHADER, "screen.vert"}, {GL_FRAGMENT_SHADER, "overlay.frag"}};
  GlBuffer counters, wide_list, no_particles, values;
  GLuint vertex_array = 0;
  std::array<ViewTargets, max_views> targets;
  std::size_t views_drawn = 0;
  std::int64_t particles_drawn = 0;  // over all views

  State(const Scene& scene, const RenderOptions& chosen)
      : options(chosen),
        tank{static_cast<float>(scene.tank_size_m[0]), static_cast<float>(scene.tank_size_m[1]),
             static_cast<float>(scene.tank_size_m[2]), chosen.clip_to_tank ? 1.0F : 0.0F},
        timer(chosen.time_passes) {
    // An invocation of llvmpipe is a lane of the processor: work groups of one footprint only add overhead.
    if (options.thread_px == 0) options.thread_px = std::min(gl_is_software() ? 64 : 16, options.group_px);
    counters.reserve(sizeof(RenderCounts));
    counters.fill(0);
    no_particles.reserve(16);
    glCreateVertexArrays(1, &vertex_array);
  }
  ~State() { glDeleteVertexArrays(1, &vertex_array); }

  /// A view of the last draw, ready to be read.
  const ViewTargets& drawn(std::size_t view) const;
  void write_block(ViewTargets& t) const;
  void clear(ViewTargets& t, std::int64_t count);
  void splat_particles(ViewTargets& t, unsigned particles, std::int64_t count);
  void splat_round(int second_round, std::int64_t count);
  void dispatch_wide(const GlProgram& program, std::int64_t count, int all_items) const;
  void find_front(std::int64_t count);
  void smooth_depth(ViewTargets& t, unsigned particles);
  void smooth_thickness(ViewTargets& t, unsigned particles);
  void shade(const ViewTargets& t, unsigned framebuffer);
  void draw_view(ViewTargets& t, const ParticleBuffer& particles, unsigned framebuffer);
};

void FluidRenderer::State::write_block(ViewTargets& t) const {
  const auto step = static_cast<float>(options.thickness_step);
  const ViewBlock block{
      t.view.view,
      rigid_inverse(t.view.view),
      pack(pixel_rays(t.view)),
      {t.width, t.height, t.cells_x, t.cells_y},
      {static_cast<float>(t.view.viewport.x), static_cast<float>(t.view.viewport.y),
       static_cast<float>(t.view.near_m), options.radius_scale},
      {options.filter_sigma_r, options.filter_delta_r, options.filter_mu_r,
       static_cast<float>(options.filter_max_px)},
      {1 / options.thickness_unit_m, options.thickness_unit_m / options.packing, step,
       static_cast<float>(options.filter_max_taps)},
      {options.absorption_per_m[0], options.absorption_per_m[1], options.absorption_per_m[2], 0},
      tank};
  glNamedBufferSubData(t.block.name(), 0, sizeof block, &block);
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, t.block.name());
}

void FluidRenderer::State::clear(ViewTargets& t, std::int64_t count) {
  // The passes of the last view wrote these buffers; a clear is no shader access.
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  t.follow(count);
  wide_list.reserve(4 * (list_header_words + 2 * count));
  wide_list.fill(0, 4 * list_header_words);
  t.depth.fill(infinity_bits);
  t.front.fill(GBuffer::no_particle);
  t.thickness.fill(0);
}

/// Runs a program on the wide footprints of the last round, or of both.
void FluidRenderer::State::dispatch_wide(const GlProgram& program, std::int64_t count, int all_items) const {
  wide_dispatch.use();
  glUniform1ui(wide_dispatch.uniform("tile_groups"), tile_groups);
  glUniform1i(wide_dispatch.uniform("all_items"), all_items);
  glDispatchCompute(1, 1, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
  program.use();
  glUniform1ui(program.uniform("particle_count"), static_cast<GLuint>(count));
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, wide_list.name());
  for (int tiles = 0; tiles < 2; ++tiles) {
    glUniform1i(program.uniform("tiles"), tiles);
    glDispatchComputeIndirect(tiles ? 20 : 8);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void FluidRenderer::State::splat_round(int second_round, std::int64_t count) {
  splat.use();
  glUniform1ui(splat.uniform("particle_count"), static_cast<GLuint>(count));
  glUniform1i(splat.uniform("thread_limit"), options.thread_px);
  glUniform1i(splat.uniform("group_limit"), options.group_px);
  glUniform1i(splat.uniform("second_round"), second_round);
  dispatch_particles(count);
  timer.mark("splat small");
  dispatch_wide(splat_wide, count, 0);
  timer.mark("splat wide");
}

void FluidRenderer::State::splat_particles(ViewTargets& t, unsigned particles, std::int64_t count) {
  bind({particles, t.depth.name(), t.front.name(), t.thickness.name(), counters.name(), wide_list.name(),
        t.touched.name(), t.blocks.name()});
  splat_round(0, count);
  block_depth.use();
  dispatch_pixels((t.width + block_px - 1) / block_px, (t.height + block_px - 1) / block_px);
  timer.mark("occlusion");
  splat_round(1, count);
}

void FluidRenderer::State::find_front(std::int64_t count) {
  front.use();
  glUniform1ui(front.uniform("particle_count"), static_cast<GLuint>(count));
  glUniform1i(front.uniform("thread_limit"), options.thread_px);
  dispatch_particles(count);
  dispatch_wide(front_wide, count, 1);
  timer.mark("front");
}

void FluidRenderer::State::smooth_depth(ViewTargets& t, unsigned particles) {
  filter_depth.use();
  const GlBuffer* source = &t.depth;
  const int wide_passes = 2 * options.filter_rounds;
  for (int pass = 0; pass < wide_passes + 2; ++pass) {
    GlBuffer* target = pass % 2 == 0 ? &t.filter_a : &t.filter_b;
    bind({particles, source->name(), t.front.name(), target->name(), counters.name()});
    glUniform1i(filter_depth.uniform("dense"), pass >= wide_passes);
    glUniform1i(filter_depth.uniform("counts"), pass < 2);
    glUniform2i(filter_depth.uniform("direction"), pass % 2 == 0, pass % 2 == 1);
    dispatch_pixels(t.width, t.height);
    source = target;
  }
  timer.mark("filter");
  clean_depth.use();
  bind({particles, t.filter_b.name(), t.front.name(), t.filter_a.name()});
  dispatch_pixels(t.width, t.height);
  timer.mark("clean-up");
  normals.use();
  bind({particles, t.filter_a.name(), t.front.name(), t.normals.name()});
  dispatch_pixels(t.width, t.height);
  timer.mark("normals");
}

void FluidRenderer::State::smooth_thickness(ViewTargets& t, unsigned particles) {
  thickness_first.use();
  bind(
      {particles, t.front.name(), t.depth.name(), t.thickness_b.name(), counters.name(), t.thickness.name()});
  glUniform2i(thickness_first.uniform("direction"), 1, 0);
  dispatch_pixels(t.cells_x, t.cells_y);
  thickness_second.use();
  bind({particles, t.front.name(), t.depth.name(), t.thickness_a.name(), counters.name(),
        t.thickness_b.name()});
  glUniform2i(thickness_second.uniform("direction"), 0, 1);
  dispatch_pixels(t.cells_x, t.cells_y);
  timer.mark("thickness");
}

void FluidRenderer::State::shade(const ViewTargets& t, unsigned framebuffer) {
  const Viewport& v = t.view.viewport;
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  glViewport(v.x, v.y, v.width, v.height);
  composite.use();
  bind({t.filter_a.name(), t.normals.name(), t.thickness_a.name()});
  glBindVertexArray(vertex_array);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  timer.mark("shade");
}

void FluidRenderer::State::draw_view(ViewTargets& t, const ParticleBuffer& particles, unsigned framebuffer) {
  const std::int64_t count = particles.count();
  const unsigned name = particles.gl_name() ? particles.gl_name() : no_particles.name();
  write_block(t);
  clear(t, count);
  timer.mark("clear");
  if (count > 0) {
    splat_particles(t, name, count);
    find_front(count);
  }
  smooth_depth(t, name);
  smooth_thickness(t, name);
  shade(t, framebuffer);
}

FluidRenderer::FluidRenderer(const Scene& scene, const RenderOptions& options) {
  check_options(options);
  state_ = std::make_unique<State>(scene, options);
}

FluidRenderer::~FluidRenderer() = default;

void FluidRenderer::draw(const ParticleBuffer& particles, std::span<const View> views, unsigned framebuffer) {
  if (views.empty() || views.size() > max_views) {
    throw base::Error("renderer", std::to_string(views.size()) + " views", "draw one view or two");
  }
  for (const View& view : views) check_view(view);
  State& s = *state_;
  s.timer.start();
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  s.counters.fill(0);
  for (std::size_t i = 0; i < views.size(); ++i) {
    s.targets[i].resize(views[i], s.options.thickness_step);
    s.draw_view(s.targets[i], particles, framebuffer);
  }
  s.views_drawn = views.size();
  s.particles_drawn = particles.count() * static_cast<std::int64_t>(views.size());
  glUseProgram(0);
}

void FluidRenderer::paint(const Overlay& overlay, unsigned framebuffer) {
  State& s = *state_;
  if (s.views_drawn == 0) throw base::Error("overlay", "nothing was drawn", "draw the particles first");
  if (!(std::isfinite(overlay.low) && std::isfinite(overlay.high) && overlay.low < overlay.high)) {
    throw base::Error("overlay", "the scale is empty or not finite", "give it low < high");
  }
  if (overlay.values.empty()) return;
  const auto bytes = static_cast<GLsizeiptr>(overlay.values.size_bytes());
  s.values.reserve(bytes);
  glNamedBufferSubData(s.values.name(), 0, bytes, overlay.values.data());
  const GlProgram& program = s.overlay;
  program.use();
  glUniform2f(program.uniform("range"), overlay.low, overlay.high);
  glUniform1i(program.uniform("classes"), overlay.classes);
  glUniform1ui(program.uniform("value_count"), static_cast<GLuint>(overlay.values.size()));
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  glBindVertexArray(s.vertex_array);
  for (std::size_t i = 0; i < s.views_drawn; ++i) {
    const ViewTargets& t = s.targets[i];
    const Viewport& v = t.view.viewport;
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, t.block.name());
    bind({t.front.name(), s.values.name(), t.normals.name()});
    glViewport(v.x, v.y, v.width, v.height);
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }
  glBindVertexArray(0);
  glDisable(GL_BLEND);
  glUseProgram(0);
}

RenderCounts FluidRenderer::counts() const {
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  RenderCounts counts;
  static_assert(sizeof(RenderCounts) == 44, "counters.glsl lists the same words");
  state_->counters.read(&counts, sizeof counts);
  counts.by_thread = static_cast<std::uint32_t>(state_->particles_drawn) - counts.not_finite -
                     counts.outside - counts.beyond_walls - counts.by_group - counts.by_tiles;
  return counts;
}

std::vector<PassTime> FluidRenderer::times() const { return state_->timer.times(); }

const ViewTargets& FluidRenderer::State::drawn(std::size_t view) const {
  if (view >= views_drawn)
    throw base::Error("G-buffer", "view " + std::to_string(view) + " was not drawn", "draw it first");
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  return targets[view];
}

GlPicture FluidRenderer::picture(std::size_t view) const {
  const ViewTargets& t = state_->drawn(view);
  return {t.width, t.height, t.view, state_->options.radius_scale, t.depth.ref(), t.normals.ref()};
}

void FluidRenderer::read_picture(GBuffer& out, std::size_t view) const {
  state_->drawn(view).read_picture(state_->options, out);
}

std::vector<float> FluidRenderer::read_depth(std::size_t view) const {
  std::vector<float> out;
  state_->drawn(view).read_depth(out);
  return out;
}

GBuffer FluidRenderer::read_gbuffer(std::size_t view) const {
  return state_->drawn(view).read_gbuffer(state_->options);
}

}  // namespace sim
