/// The passes of a FluidRenderer that splat particles and foam into depths and thicknesses.

#include "libsim/render/render_passes.hpp"

namespace sim {

namespace {

constexpr int block_px = 16;        // equal to block_px of occlusion.glsl
constexpr GLuint tile_groups = 64;  // work groups per footprint wider than group_px; a multiple of 8

}  // namespace

const FluidRenderer::State::Splats& FluidRenderer::State::splats_of(bool with_shapes) {
  std::optional<Splats>& out = splats[with_shapes];
  if (!out) {
    const std::string shape = with_shapes ? "#define ELLIPSOIDS\n" : "";
    const std::string front_shape = shape + "#define FRONT\n";
    out = Splats{.small = compute_program("splat.comp", shape.c_str()),
                 .wide = compute_program("splat_wide.comp", shape.c_str()),
                 .front = compute_program("front.comp", shape.c_str()),
                 .front_wide = compute_program("splat_wide.comp", front_shape.c_str())};
  }
  return *out;
}

void FluidRenderer::State::bind_splat(const ViewTargets& t) const {
  bind_storage({particles_, t.depth.name(), t.front.name(), t.thickness.name(), counters.name(),
                t.wide_list.name(), t.touched.name(), t.blocks.name(), shapes_});
}

/// Runs a program on the particles with large footprints that the last of the two rounds of splatting
/// (shaders/occlusion.glsl) listed; if all_items is 1, on those that both rounds listed.
void FluidRenderer::State::dispatch_wide(const GlProgram& program, int all_items) {
  wide_dispatch.use();
  glUniform1ui(wide_dispatch.uniform("tile_groups"), tile_groups);
  glUniform1i(wide_dispatch.uniform("all_items"), all_items);
  each_view(
      [&](const ViewTargets& t) {
        bind_splat(t);
        glDispatchCompute(1, 1, 1);
      },
      GL_COMMAND_BARRIER_BIT);
  program.use();
  glUniform1ui(program.uniform("particle_count"), static_cast<GLuint>(count_));
  each_view([&](const ViewTargets& t) {
    bind_splat(t);
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, t.wide_list.name());
    for (int tiles = 0; tiles < 2; ++tiles) {
      glUniform1i(program.uniform("tiles"), tiles);
      glDispatchComputeIndirect(tiles ? 20 : 8);
    }
  });
}

void FluidRenderer::State::splat_round(int second_round) {
  const Splats& programs = splats_of(shapes_ != 0);
  const GlProgram& splat = programs.small;
  splat.use();
  glUniform1ui(splat.uniform("particle_count"), static_cast<GLuint>(count_));
  glUniform1i(splat.uniform("thread_limit"), options.thread_px);
  glUniform1i(splat.uniform("group_limit"), options.group_px);
  glUniform1i(splat.uniform("second_round"), second_round);
  each_view([&](const ViewTargets& t) {
    bind_splat(t);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2,
                     t.filter_a.name());  // filtered nearness of the last picture
    dispatch_particles(count_);
  });
  timer.mark("splat small");
  dispatch_wide(programs.wide, 0);
  timer.mark("splat wide");
}

void FluidRenderer::State::splat_particles() {
  splat_round(0);
  block_depth.use();
  each_view([&](const ViewTargets& t) {
    bind_splat(t);
    glDispatchCompute(static_cast<GLuint>(t.width + block_px - 1) / block_px,
                      static_cast<GLuint>(t.height + block_px - 1) / block_px, 1);
  });
  timer.mark("occlusion");
  splat_round(1);
}

void FluidRenderer::State::find_front() {
  const Splats& programs = splats_of(shapes_ != 0);
  const GlProgram& front = programs.front;
  front.use();
  glUniform1ui(front.uniform("particle_count"), static_cast<GLuint>(count_));
  glUniform1i(front.uniform("thread_limit"), options.thread_px);
  each_view([&](const ViewTargets& t) {
    bind_splat(t);
    dispatch_particles(count_);
  });
  dispatch_wide(programs.front_wide, 1);
  timer.mark("front");
}

void FluidRenderer::State::splat_foam(const ParticleBuffer& from) {
  splat_foam_program.use();
  tell_obstacles(splat_foam_program);
  glUniform1ui(splat_foam_program.uniform("foam_count"), static_cast<GLuint>(from.count()));
  each_view([&](const ViewTargets& t) {
    bind_storage({from.gl_name(), t.filter_a.name(), t.normals.name(), t.foam.name()});
    bind_obstacles();
    dispatch_particles(from.count());
  });
  timer.mark("foam");
}

}  // namespace sim
