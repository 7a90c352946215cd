#include "libsim/render/render_passes.hpp"

#include <algorithm>
#include <cstdint>

#include "libsim/render/gl_context.hpp"
#include "stats/base/error.hpp"

namespace sim {

namespace {

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

std::array<float, 4> pack(const PixelRays& rays) {
  return {rays.scale_x, rays.offset_x, rays.scale_y, rays.offset_y};
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

}  // namespace

void bind_storage(std::initializer_list<unsigned> buffers) {
  GLuint binding = 0;
  for (const unsigned buffer : buffers) {
    if (buffer) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer);
    ++binding;
  }
}

GlProgram compute_program(const char* file, const char* defines) {
  return GlProgram({{GL_COMPUTE_SHADER, file}}, defines);
}

FluidRenderer::State::State(const Scene& scene, const RenderOptions& chosen)
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

FluidRenderer::State::~State() { glDeleteVertexArrays(1, &vertex_array); }

const ViewTargets& FluidRenderer::State::drawn(std::size_t view) const {
  if (view >= views_drawn)
    throw base::Error("G-buffer", "view " + std::to_string(view) + " was not drawn", "draw it first");
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  return targets[view];
}

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
  bind_storage({particles, t.depth.name(), t.front.name(), t.thickness.name(), counters.name(),
                wide_list.name(), t.touched.name(), t.blocks.name()});
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
    bind_storage({particles, source->name(), t.front.name(), target->name(), counters.name()});
    glUniform1i(filter_depth.uniform("dense"), pass >= wide_passes);
    glUniform1i(filter_depth.uniform("counts"), pass < 2);
    glUniform2i(filter_depth.uniform("direction"), pass % 2 == 0, pass % 2 == 1);
    dispatch_pixels(t.width, t.height);
    source = target;
  }
  timer.mark("filter");
  clean_depth.use();
  bind_storage({particles, t.filter_b.name(), t.front.name(), t.filter_a.name()});
  dispatch_pixels(t.width, t.height);
  timer.mark("clean-up");
  normals.use();
  bind_storage({particles, t.filter_a.name(), t.front.name(), t.normals.name()});
  dispatch_pixels(t.width, t.height);
  timer.mark("normals");
}

void FluidRenderer::State::smooth_thickness(ViewTargets& t, unsigned particles) {
  thickness_first.use();
  bind_storage(
      {particles, t.front.name(), t.depth.name(), t.thickness_b.name(), counters.name(), t.thickness.name()});
  glUniform2i(thickness_first.uniform("direction"), 1, 0);
  dispatch_pixels(t.cells_x, t.cells_y);
  thickness_second.use();
  bind_storage({particles, t.front.name(), t.depth.name(), t.thickness_a.name(), counters.name(),
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
  bind_storage({t.filter_a.name(), t.normals.name(), t.thickness_a.name()});
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

}  // namespace sim
