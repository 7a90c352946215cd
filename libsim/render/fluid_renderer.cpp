#include "libsim/render/fluid_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "libsim/render/render_passes.hpp"
#include "stats/base/error.hpp"

namespace sim {

static_assert(sizeof(RenderParticle) == 16 && sizeof(RenderShape) == 16,
              "the shaders read a particle as one vec4 and a shape as one uvec4");

const char* surface_name(Surface surface) { return surface == Surface::Spheres ? "spheres" : "ellipsoids"; }

Surface parse_surface(const std::string& word) {
  for (const Surface surface : {Surface::Ellipsoids, Surface::Spheres})
    if (word == surface_name(surface)) return surface;
  throw base::Error("surface '" + word + "'", "is unknown", "use ellipsoids or spheres");
}

void ParticleBuffer::upload(std::span<const RenderParticle> particles, std::span<const RenderShape> shapes) {
  const auto count = static_cast<std::int64_t>(particles.size());
  if (!shapes.empty() && shapes.size() != particles.size()) {
    throw base::Error(
        "particle buffer",
        "got " + std::to_string(shapes.size()) + " shapes for " + std::to_string(count) + " particles",
        "give one shape per particle, or none");
  }
  shapes.empty() ? reserve(count) : reserve_with_shapes(count);
  if (count > 0) buffer_.write(particles.data(), static_cast<std::int64_t>(particles.size_bytes()));
  if (!shapes.empty()) shapes_.write(shapes.data(), static_cast<std::int64_t>(shapes.size_bytes()));
  count_ = count;
}

void ParticleBuffer::reserve(std::int64_t capacity) {
  with_shapes_ = false;
  if (gl_name() && capacity <= capacity_) return;
  capacity_ = capacity < 1 ? 1 : capacity;
  count_ = 0;
  buffer_.reserve(capacity_ * 16);
}

void ParticleBuffer::reserve_with_shapes(std::int64_t capacity) {
  reserve(capacity);
  shapes_.reserve(capacity_ * 16);
  with_shapes_ = true;
}

void ParticleBuffer::set_count(std::int64_t count) {
  if (count < 0 || count > capacity_) {
    throw base::Error(
        "particle buffer",
        "has room for " + std::to_string(capacity_) + " particles, not for " + std::to_string(count),
        "call reserve() before set_count()");
  }
  count_ = count;
}

namespace {

void check(bool good, const std::string& what, const char* mend) {
  if (!good) throw base::Error("render options", what, mend);
}

void check_options(const RenderOptions& o) {
  const auto positive = [](float value) { return std::isfinite(value) && value > 0; };
  const auto n = [](auto value) { return std::to_string(value); };
  check(positive(o.radius_scale), "radius_scale = " + n(o.radius_scale) + " is not positive",
        "use about 1.5");
  check(positive(o.filter_sigma_r) && positive(o.filter_delta_r) && positive(o.filter_mu_r),
        "filter_sigma_r = " + n(o.filter_sigma_r) + ", filter_delta_r = " + n(o.filter_delta_r) +
            " and filter_mu_r = " + n(o.filter_mu_r) + " are not all positive",
        "use about 1.1, 4 and 1");
  check(o.filter_max_px >= 1 && o.filter_max_taps >= 1,
        "filter_max_px = " + n(o.filter_max_px) + " and filter_max_taps = " + n(o.filter_max_taps) +
            " are not both at least 1",
        "use about 256 px and 12 samples");
  check(o.filter_rounds >= 1 && o.filter_rounds <= 8,
        "filter_rounds = " + n(o.filter_rounds) + " is not 1 to 8", "use 2");
  check(o.thickness_step == 1 || o.thickness_step == 2 || o.thickness_step == 4,
        "thickness_step = " + n(o.thickness_step) + " is not 1, 2 or 4", "use 2");
  check(positive(o.thickness_unit_m) && positive(o.packing),
        "thickness_unit_m = " + n(o.thickness_unit_m) + " and packing = " + n(o.packing) +
            " are not both positive",
        "use 1/65536 m and pi/6");
  check(o.thread_px >= 0 && o.group_px >= std::max(o.thread_px, 1),
        "thread_px = " + n(o.thread_px) + " and group_px = " + n(o.group_px) +
            " are not 0 <= thread_px <= group_px with group_px >= 1",
        "use 0 and 128");
  check(o.floor_cells >= 64 && o.floor_cells <= 2048,
        "floor_cells = " + n(o.floor_cells) + " is not 64 to 2048", "use 512");
}

void check_view(const View& view) {
  const auto finite = [](const Mat4& m) {
    return std::all_of(m.begin(), m.end(), [](float v) { return std::isfinite(v); });
  };
  if (view.viewport.width < 1 || view.viewport.height < 1 || !finite(view.view) || !finite(view.projection) ||
      view.projection[0] == 0 || view.projection[5] == 0 || !(view.near_m > 0)) {
    throw base::Error("view",
                      "has an empty viewport (" + std::to_string(view.viewport.width) + " x " +
                          std::to_string(view.viewport.height) +
                          " px), a matrix that is not finite, a projection without a field of view, or a "
                          "near plane at or behind the eye (near_m = " +
                          std::to_string(view.near_m) + ")",
                      "give each view a viewport of at least 1 x 1 px, finite matrices, a perspective "
                      "projection and near_m > 0");
  }
}

}  // namespace

std::string passes_in_words(const Scene& scene) {
  const float foam = coefficients_of(scene.effects)[EffectKind::Foam];
  std::ostringstream out, absent;
  out << "  picture: clear, splat small, splat wide, occlusion, front, wet tiles, filter, clean-up, normals, "
         "thickness, ";
  const auto add = [&](const char* pass, const char* key, float value) {
    if (value > 0) {
      out << pass << " (the scene lists " << key << " = " << value << "), ";
    } else {
      absent << "  -  " << std::left << std::setw(20) << pass << "not called for\n";
    }
  };
  add("foam", traits_of(EffectKind::Foam).key, foam);
  if (lights_the_floor(scene)) out << "light (for what follows), ";
  for (std::size_t k = 0; k < picture_effect_count; ++k) {
    const auto kind = static_cast<PictureEffectKind>(k);
    const bool asked_by_light = kind == PictureEffectKind::Shadows && floor_strength(scene, kind) > 0 &&
                                strength_of(scene.picture_effects, kind) == 0;
    if (asked_by_light) {
      out << traits_of(kind).word << " ([light] has shadow = true), ";
    } else {
      add(traits_of(kind).word, "strength", floor_strength(scene, kind));
    }
  }
  out << "shade, edges\n" << absent.str();
  return out.str();
}

FluidRenderer::FluidRenderer(const Scene& scene, const RenderOptions& options) {
  check_options(options);
  check_picture_effects(scene.picture_effects);
  check_light(scene.light);
  state_ = std::make_unique<State>(scene, options);
}

FluidRenderer::~FluidRenderer() = default;

void FluidRenderer::place_obstacles(double time_s) {
  state_->place_obstacles(motions_at(state_->obstacles, time_s));
}
void FluidRenderer::place_obstacles(const std::vector<BodyMotion>& motions) {
  state_->place_obstacles(motions);
}

void FluidRenderer::draw(const ParticleBuffer& particles, std::span<const View> views, unsigned framebuffer,
                         const ParticleBuffer* foam) {
  if (views.empty() || views.size() > most_views) {
    throw base::Error("renderer", "was given " + std::to_string(views.size()) + " views",
                      "draw one view or two");
  }
  for (const View& view : views) check_view(view);
  State& s = *state_;
  s.timer.start();
  s.draw_views(particles, views, framebuffer, foam);
  s.particles_drawn = particles.count() * static_cast<std::int64_t>(views.size());
  glUseProgram(0);
}

void FluidRenderer::paint(const Overlay& overlay, unsigned framebuffer) {
  State& s = *state_;
  if (s.views_drawn == 0) throw base::Error("overlay", "nothing was drawn", "draw the particles first");
  if (!(std::isfinite(overlay.low) && std::isfinite(overlay.high) && overlay.low < overlay.high)) {
    throw base::Error("overlay",
                      "the scale from low = " + std::to_string(overlay.low) +
                          " to high = " + std::to_string(overlay.high) + " is empty or not finite",
                      "give it finite limits, low < high");
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
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);  // the picture stays opaque
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  glBindVertexArray(s.vertex_array);
  for (std::size_t i = 0; i < s.views_drawn; ++i) {
    const ViewTargets& t = s.targets[i];
    const Viewport& v = t.view.viewport;
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, t.block.name());
    bind_storage({t.front.name(), s.values.name(), t.normals.name()});
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

GlPicture FluidRenderer::picture(std::size_t view) const {
  const ViewTargets& t = state_->drawn(view);
  return {t.width, t.height, t.view, state_->drawn_radius_scale(), t.depth.ref(), t.normals.ref()};
}

void FluidRenderer::read_picture(GBuffer& out, std::size_t view) const {
  state_->drawn(view).read_picture(state_->drawn_radius_scale(), out);
}

std::vector<float> FluidRenderer::read_depth(std::size_t view) const {
  std::vector<float> out;
  state_->drawn(view).read_depth(out);
  return out;
}

FloorMap FluidRenderer::read_floor() const {
  const State& s = *state_;
  if (!s.floor_light || s.views_drawn == 0)
    throw base::Error("light on the floor",
                      "nothing was drawn, or the scene lists no picture effect with a strength above 0",
                      "list a picture effect and draw first");
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  return s.floor_light->read();
}

GBuffer FluidRenderer::read_gbuffer(std::size_t view) const {
  return state_->drawn(view).read_gbuffer(state_->drawn_radius_scale(), state_->options);
}

}  // namespace sim
