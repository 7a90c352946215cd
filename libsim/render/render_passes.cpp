#include "libsim/render/render_passes.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <iterator>
#include <memory>

#include "libsim/gl/gl_context.hpp"
#include "libsim/scene/mesh.hpp"
#include "stats/base/error.hpp"

namespace sim {

namespace {

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

}  // namespace

void dispatch_pixels(int width, int height) {
  glDispatchCompute(static_cast<GLuint>(width + 15) / 16, static_cast<GLuint>(height + 7) / 8, 1);
}

void dispatch_particles(std::int64_t count) {
  const std::int64_t groups = (count + 63) / 64;
  const std::int64_t across = std::min<std::int64_t>(groups, 32768);
  glDispatchCompute(static_cast<GLuint>(across), static_cast<GLuint>((groups + across - 1) / across), 1);
}

void dispatch_tiles(const ViewTargets& view, bool wet) {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 8, view.tiles.name());
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, view.tiles.name());
  glDispatchComputeIndirect(wet ? 0 : 16);
}

void bind_storage(std::initializer_list<unsigned> buffers) {
  glBindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizei>(buffers.size()), std::data(buffers));
}

GlProgram compute_program(const char* file, const char* defines) {
  return GlProgram({{GL_COMPUTE_SHADER, file}}, defines);
}

namespace {
/// #define lines for the composite and the foam pass: those of the scene's foam and obstacles.
std::string defines_of(const Scene& scene) {
  return std::string(coefficients_of(scene.effects)[EffectKind::Foam] > 0 ? "#define FOAM\n" : "") +
         obstacle_defines(scene);
}

/// The program that shades tiles with water, or those without (`which`).
GlProgram composite_of(const Scene& scene, const Surroundings& surroundings, const char* which) {
  const std::string light = lights_the_floor(scene) ? "#define LIT_FLOOR\n" : "";
  return compute_program("composite.comp",
                         (defines_of(scene) + surroundings.defines() + light + which).c_str());
}

/// Distance grids of the meshes in the layout of shaders/obstacle_meshes.glsl; empty without meshes.
std::vector<std::uint32_t> grids_of(const std::vector<Obstacle>& obstacles) {
  std::vector<std::uint32_t> out;
  if (!any_mesh(obstacles)) return out;
  constexpr std::size_t head = 8;
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  out.resize(head * obstacles.size());
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    if (!obstacles[k].mesh) continue;
    const DistanceGrid& grid = obstacles[k].mesh->grid();
    std::uint32_t* const row = &out[head * k];
    for (std::size_t a = 0; a < 3; ++a) {
      row[a] = bits(static_cast<float>(grid.low_m[a]));
      row[4 + a] = static_cast<std::uint32_t>(grid.nodes[a]);
    }
    row[3] = bits(static_cast<float>(grid.step_m));
    row[7] = static_cast<std::uint32_t>(out.size());
    std::transform(grid.values_m.begin(), grid.values_m.end(), std::back_inserter(out), bits);
  }
  return out;
}
}  // namespace

std::string obstacle_defines(const Scene& scene) {
  if (scene.obstacles.empty()) return scene.nozzles.empty() ? "" : "#define OBSTACLES\n#define ONLY_PIPES\n";
  return any_mesh(scene.obstacles) ? "#define OBSTACLES\n#define MESHES\n" : "#define OBSTACLES\n";
}

FluidRenderer::State::State(const Scene& scene, const RenderOptions& chosen)
    : options(chosen),
      tank{static_cast<float>(scene.tank_size_m[0]), static_cast<float>(scene.tank_size_m[1]),
           static_cast<float>(scene.tank_size_m[2]), chosen.clip_to_tank ? 1.0F : 0.0F},
      absorption{static_cast<float>(scene.light.absorption_per_m[0]),
                 static_cast<float>(scene.light.absorption_per_m[1]),
                 static_cast<float>(scene.light.absorption_per_m[2]), scene.lid ? 1.0F : 0.0F},
      timer(chosen.time_passes),
      foam(coefficients_of(scene.effects)[EffectKind::Foam] > 0),
      floor_light(lights_the_floor(scene) ? std::make_unique<FloorLight>(scene, chosen) : nullptr),
      surroundings(scene),
      composite(composite_of(scene, surroundings, "")),
      composite_dry(composite_of(scene, surroundings, "#define DRY\n")),
      outlines(compute_program("outlines.comp", foam ? "#define FOAM\n" : "")),
      splat_foam_program(foam ? compute_program("foam_splat.comp", defines_of(scene).c_str()) : GlProgram()),
      obstacles(scene.obstacles),
      pipes(pipes_of(scene)) {
  // On llvmpipe one invocation draws footprints of up to 64 px, on a GPU of up to 16 px: llvmpipe runs
  // invocations as SIMD lanes, so that a team of invocations for a small footprint is slower there.
  if (options.thread_px == 0) options.thread_px = std::min(gl_is_software() ? 64 : 16, options.group_px);
  splats_of(options.surface == Surface::Ellipsoids);
  counters.reserve(sizeof(RenderCounts));
  counters.fill(0);
  no_particles.reserve(16);
  glCreateVertexArrays(1, &vertex_array);
  place_obstacles(motions_at(obstacles, 0));
  const auto words = grids_of(obstacles);
  if (words.empty()) return;
  const auto bytes = static_cast<std::int64_t>(words.size() * sizeof words[0]);
  grids.reserve(bytes);
  grids.write(words.data(), bytes);
}

void FluidRenderer::State::place_obstacles(const std::vector<BodyMotion>& motions) {
  if (solids() == 0) return;
  std::vector<std::array<float, 4>> rows;
  const auto row = [&](const auto& v, double last) {
    rows.push_back({static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]),
                    static_cast<float>(last)});
  };
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    const Obstacle& o = obstacles[k];
    const Pose& pose = motions.at(k).pose;
    row(pose.centre_m, o.radius_m);
    row(half_sides_m(o), o.mesh ? 1 : 0);
    row(pose.turn, pose.turn[3]);
  }
  for (const Pipe& pipe : pipes) {
    row(pipe.centre_m, pipe.radius_m);
    row(Vec3d{0, pipe.half_length_m, 0}, 2);  // pipe_kind of obstacles.glsl
    row(Vec3d{}, 1);
  }
  const auto bytes = static_cast<GLsizeiptr>(rows.size() * sizeof rows[0]);
  poses.reserve(bytes);
  glNamedBufferSubData(poses.name(), 0, bytes, rows.data());
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
  // A drawn sphere or ellipsoid holds the volume of a sphere of radius_scale particle radii.
  const float filled = options.packing * options.radius_scale * options.radius_scale * options.radius_scale;
  const ViewBlock block{t.view.view,
                        rigid_inverse(t.view.view),
                        pack(pixel_rays(t.view)),
                        {t.width, t.height, t.cells_x, t.cells_y},
                        {static_cast<float>(t.view.viewport.x), static_cast<float>(t.view.viewport.y),
                         static_cast<float>(t.view.near_m), options.radius_scale},
                        {options.filter_sigma_r, options.filter_delta_r, options.filter_mu_r,
                         static_cast<float>(options.filter_max_px)},
                        {1 / options.thickness_unit_m, options.thickness_unit_m / filled, step,
                         static_cast<float>(options.filter_max_taps)},
                        absorption,
                        tank};
  glNamedBufferSubData(t.block.name(), 0, sizeof block, &block);
}

void FluidRenderer::State::clear() {
  clear_targets.use();
  each_view([&](const ViewTargets& t) {
    bind_storage({0, t.depth.name(), t.front.name(), t.thickness.name(), counters.name(), t.wide_list.name(),
                  t.wet.name(), 0, t.tiles.name()});
    dispatch_pixels(t.width, t.height);
  });
  timer.mark("clear");
}

void FluidRenderer::State::smooth_depth() {
  wet_tiles.use();
  each_view(
      [&](const ViewTargets& t) {
        bind_storage({particles_, t.depth.name(), t.front.name(), t.radii.name(), counters.name(),
                      t.wet.name(), t.filter_b.name(), 0, t.tiles.name()});
        dispatch_pixels(t.width, t.height);
      },
      GL_COMMAND_BARRIER_BIT);
  timer.mark("wet tiles");
  filter_depth.use();
  const int wide_passes = 2 * options.filter_rounds;
  for (int pass = 0; pass < wide_passes + 2; ++pass) {
    glUniform1i(filter_depth.uniform("dense"), pass >= wide_passes);
    glUniform1i(filter_depth.uniform("counts"), pass < 2);
    glUniform2i(filter_depth.uniform("direction"), pass % 2 == 0, pass % 2 == 1);
    each_view([&](const ViewTargets& t) {
      const GlBuffer& from = pass % 2 == 0 ? t.filter_b : t.filter_a;
      const GlBuffer& to = pass % 2 == 0 ? t.filter_a : t.filter_b;
      bind_storage({0, from.name(), t.radii.name(), to.name(), counters.name()});
      dispatch_tiles(t, true);
    });
  }
  timer.mark("filter");
  clean_depth.use();
  each_view([&](const ViewTargets& t) {
    bind_storage({0, t.filter_b.name(), t.radii.name(), t.filter_a.name()});
    dispatch_tiles(t, true);
  });
  timer.mark("clean-up");
  normals.use();
  each_view([&](const ViewTargets& t) {
    bind_storage({0, t.filter_a.name(), t.radii.name(), t.normals.name()});
    dispatch_tiles(t, true);
  });
  timer.mark("normals");
}

void FluidRenderer::State::smooth_thickness() {
  thickness_first.use();
  glUniform2i(thickness_first.uniform("direction"), 1, 0);
  each_view([&](const ViewTargets& t) {
    bind_storage(
        {0, t.depth.name(), t.radii.name(), t.thickness_b.name(), counters.name(), t.thickness.name()});
    dispatch_pixels(t.cells_x, t.cells_y);
  });
  thickness_second.use();
  glUniform2i(thickness_second.uniform("direction"), 0, 1);
  each_view([&](const ViewTargets& t) {
    bind_storage(
        {0, t.depth.name(), t.radii.name(), t.thickness_a.name(), counters.name(), t.thickness_b.name()});
    dispatch_pixels(t.cells_x, t.cells_y);
  });
  timer.mark("thickness");
}

void FluidRenderer::State::bind_obstacles() const {
  if (solids() > 0) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 4, poses.name());
  if (grids.name()) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 5, grids.name());
}

void FluidRenderer::State::light_floor() {
  floor_light->compute({particles_, count_, poses.name(), grids.name(), solids()}, timer);
}

void FluidRenderer::State::shade() {
  if (floor_light) floor_light->bind();
  for (const GlProgram* program : {&composite, &composite_dry}) {
    program->use();
    tell_obstacles(*program);
    surroundings.bind(*program);
  }
  each_view([&](const ViewTargets& t) {
    bind_storage({t.filter_a.name(), t.normals.name(), t.thickness_a.name(), t.foam.name(), 0, 0,
                  t.shaded.name(), t.shown.name()});
    bind_obstacles();
    dispatch_tiles(t, false);
    composite.use();
    dispatch_tiles(t, true);
    composite_dry.use();
  });
  if (floor_light) glBindTextureUnit(0, 0);
  Surroundings::unbind();
  timer.mark("shade");
}

void FluidRenderer::State::smooth_edges() {
  constexpr std::array<GLuint, 4> no_groups{0, 1, 1, 0};
  outlines.use();
  each_view(
      [&](const ViewTargets& t) {
        glNamedBufferSubData(t.outline_tiles.name(), 0, sizeof no_groups, no_groups.data());
        bind_storage({t.shown.name(), t.normals.name(), t.outlines.name(), t.outline_tiles.name(),
                      t.foam.name(), t.wet.name()});
        dispatch_pixels(t.width, t.height);
      },
      GL_COMMAND_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  edges.use();
  each_view([&](const ViewTargets& t) {
    bind_storage({t.shaded.name(), t.outlines.name(), 0, t.outline_tiles.name()});
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, t.outline_tiles.name());
    glDispatchComputeIndirect(0);
  });
}

void FluidRenderer::State::draw_views(const ParticleBuffer& from, std::span<const View> views,
                                      unsigned framebuffer, const ParticleBuffer* foam_from) {
  particles_ = from.gl_name() ? from.gl_name() : no_particles.name();
  shapes_ = from.shapes_name();
  count_ = from.count();
  views_drawn = views.size();
  // Shaders of the last draw wrote to the buffers of `targets`. The barrier orders their writes before
  // resize(), which fills buffers without a shader.
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  for (std::size_t i = 0; i < views.size(); ++i) {
    targets[i].resize(views[i], options.thickness_step, foam);
    targets[i].follow(count_);
    write_block(targets[i]);
  }
  clear();
  if (count_ > 0) {
    splat_particles();
    find_front();
  }
  smooth_depth();
  smooth_thickness();
  if (foam && foam_from && foam_from->count() > 0) splat_foam(*foam_from);
  if (floor_light) light_floor();
  picture.begin(framebuffer, views);
  shade();
  smooth_edges();
  picture.end(framebuffer, views);
  timer.mark("edges");
}

}  // namespace sim
