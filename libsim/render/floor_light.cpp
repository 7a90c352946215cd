#include "libsim/render/floor_light.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "libsim/render/render_passes.hpp"

namespace sim {

namespace {

constexpr float height_steps = 16777216;  // fixed-point units (24 bits) in four tank heights
// Largest shift of refracted light on the floor, along x or z, divided by the water's depth: towards the sun
// and away from it. The shift is measured from where the ray would land without water. With the sun of
// shaders/light.glsl, flat water shifts light by 0.14 along x and 0.18 along z towards the sun; the rest
// allows for waves.
constexpr float aside_with_the_sun = 0.3F, aside_against_it = 0.1F;
constexpr float caustic_units = 65536;  // light units of a cell without water (caustic_units.glsl)
constexpr int border_cells = 8;         // additional surface cells per side, for the smoothing
constexpr float smoothing_r =
    2;  // standard deviation, particle radii; waves 11 radii long keep half their height
constexpr float surface_cell_in_cells = 3;  // edge of a surface cell / edge of a floor cell

// Where only [light] asks for a shadow, the maps are coarser and the shadow softer.
constexpr int soft_cells = 64;
constexpr float soft_surface_cell_in_cells = 1.5F;
constexpr float soft_strength = 0.7F;

bool lists_light(const Scene& scene) {
  return std::any_of(scene.picture_effects.begin(), scene.picture_effects.end(),
                     [](const PictureEffect& effect) { return effect.strength > 0; });
}

std::int64_t size_of(int x, int z) { return std::int64_t{x} * z; }

GLsizei levels_of(int cells) { return static_cast<GLsizei>(std::bit_width(static_cast<unsigned>(cells))); }

}  // namespace

float floor_strength(const Scene& scene, PictureEffectKind kind) {
  const bool listed = std::any_of(scene.picture_effects.begin(), scene.picture_effects.end(),
                                  [&](const PictureEffect& effect) { return effect.kind == kind; });
  if (!listed && kind == PictureEffectKind::Shadows) return scene.light.shadow ? soft_strength : 0;
  return strength_of(scene.picture_effects, kind);
}

bool lights_the_floor(const Scene& scene) {
  return floor_strength(scene, PictureEffectKind::Shadows) > 0 ||
         floor_strength(scene, PictureEffectKind::Caustics) > 0;
}

FloorLight::FloorLight(const Scene& scene, const RenderOptions& options) {
  const auto tank = [&](std::size_t k) { return static_cast<float>(scene.tank_size_m[k]); };
  const float longest = std::max(tank(0), tank(2));
  const bool listed = lists_light(scene);
  const int most_cells = listed ? options.floor_cells : std::min(options.floor_cells, soft_cells);
  const float edge = longest / static_cast<float>(most_cells);
  const float surface_edge = edge * (listed ? surface_cell_in_cells : soft_surface_cell_in_cells);
  // Assumed upper bound of the water's depth, from which the extent of the surface map beyond the floor
  // follows: the tank's height, or the floor's longer side if that is less.
  const float deepest = std::min(tank(1), longest);
  const auto cells = [](float length, float of) { return static_cast<std::int32_t>(std::ceil(length / of)); };
  const int before = cells(aside_with_the_sun * deepest, surface_edge) + border_cells;
  const int behind = cells(aside_against_it * deepest, surface_edge) + border_cells;
  const float low = -static_cast<float>(before) * surface_edge;
  block_ = {{tank(0), tank(1), tank(2), 4 * tank(1) / height_steps},
            {before + cells(tank(0), surface_edge) + behind, before + cells(tank(2), surface_edge) + behind,
             cells(tank(0), edge), cells(tank(2), edge)},
            {low, low, surface_edge, options.radius_scale},
            {edge, 1 / options.thickness_unit_m, options.thickness_unit_m / options.packing, smoothing_r},
            {floor_strength(scene, PictureEffectKind::Shadows),
             floor_strength(scene, PictureEffectKind::Caustics), 0, 0},
            {}};
  for (std::size_t k = 0; k < 3; ++k)
    block_.absorption[k] = static_cast<float>(scene.light.absorption_per_m[k]);
  splat_ = compute_program("light_splat.comp");
  splat_images_ = compute_program("light_splat.comp", "#define IMAGES\n");
  smooth_first_ = compute_program("light_smooth.comp", "#define FIRST\n");
  smooth_second_ = compute_program("light_smooth.comp");
  maps_.reserve(sizeof block_);
  maps_.write(&block_, sizeof block_);
  const auto& [surface_x, surface_z, floor_x, floor_z] = block_.cells;
  for (GlBuffer* buffer : {&top_, &thickness_, &image_top_, &image_thickness_})
    buffer->reserve(4 * size_of(surface_x, surface_z));
  for (GlBuffer* buffer : {&surface_a_, &surface_b_}) buffer->reserve(16 * size_of(surface_x, surface_z));
  std::string effects;
  if (strength(PictureEffectKind::Shadows) > 0) {
    shadows_ = compute_program("shadows.comp", obstacle_defines(scene).c_str());
    shadow_.reserve(8 * size_of(floor_x, floor_z));
    effects += "#define SHADOWS\n";
  }
  if (strength(PictureEffectKind::Caustics) > 0) {
    caustics_ = compute_program("caustics.comp", obstacle_defines(scene).c_str());
    caustic_.reserve(4 * size_of(floor_x, floor_z));
    effects += "#define CAUSTICS\n";
  }
  // Caustics are brighter than 1; a shadow alone is not, and software OpenGL reads bytes faster.
  format_ = listed ? GL_RGBA16F : GL_RGBA8;
  effects += listed ? "#define CELLS rgba16f\n" : "#define CELLS rgba8\n";
  join_ = compute_program("light_floor.comp", effects.c_str());
  glCreateTextures(GL_TEXTURE_2D, 1, &sunlight_);
  glTextureStorage2D(sunlight_, levels_of(std::max(floor_x, floor_z)), format_, floor_x, floor_z);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTextureParameteri(sunlight_, axis, GL_CLAMP_TO_EDGE);
  glTextureParameteri(sunlight_, GL_TEXTURE_MIN_FILTER,
                      listed ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR_MIPMAP_NEAREST);
}

FloorLight::~FloorLight() { glDeleteTextures(1, &sunlight_); }

void FloorLight::splat(const FloorWater& water) {
  for (GlBuffer* buffer : {&top_, &thickness_, &image_top_, &image_thickness_}) buffer->fill(0);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  if (water.count == 0) return;
  const auto run = [&](const GlProgram& program, std::initializer_list<unsigned> buffers) {
    program.use();
    glUniform1ui(program.uniform("particle_count"), static_cast<GLuint>(water.count));
    bind_storage(buffers);
    dispatch_particles(water.count);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  };
  run(splat_, {water.particles, top_.name(), thickness_.name()});
  run(splat_images_,
      {water.particles, image_top_.name(), image_thickness_.name(), top_.name(), thickness_.name()});
}

void FloorLight::smooth() {
  const auto& cells = block_.cells;
  smooth_first_.use();
  glUniform2i(smooth_first_.uniform("direction"), 1, 0);
  bind_storage(
      {top_.name(), thickness_.name(), surface_a_.name(), image_top_.name(), image_thickness_.name()});
  dispatch_pixels(cells[0], cells[1]);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  smooth_second_.use();
  glUniform2i(smooth_second_.uniform("direction"), 0, 1);
  bind_storage({surface_a_.name(), 0, surface_b_.name()});
  dispatch_pixels(cells[0], cells[1]);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void FloorLight::cast_shadows(const FloorWater& water) {
  shadows_.use();
  if (water.obstacle_count > 0) glUniform1i(shadows_.uniform("obstacle_count"), water.obstacle_count);
  bind_storage({surface_b_.name(), shadow_.name(), 0, 0, water.obstacles, water.obstacle_grids});
  dispatch_pixels(block_.cells[2], block_.cells[3]);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void FloorLight::gather_caustics(const FloorWater& water) {
  caustic_.fill(0);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  caustics_.use();
  if (water.obstacle_count > 0) glUniform1i(caustics_.uniform("obstacle_count"), water.obstacle_count);
  bind_storage({surface_b_.name(), caustic_.name(), 0, 0, water.obstacles, water.obstacle_grids});
  dispatch_pixels(block_.cells[0], block_.cells[1]);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void FloorLight::join() {
  join_.use();
  bind_storage({shadow_.name(), caustic_.name()});
  glBindImageTexture(0, sunlight_, 0, GL_FALSE, 0, GL_WRITE_ONLY, format_);
  dispatch_pixels(block_.cells[2], block_.cells[3]);
  glBindImageTexture(0, 0, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
  glGenerateTextureMipmap(sunlight_);
}

void FloorLight::compute(const FloorWater& water, PassTimer& timer) {
  glBindBufferBase(GL_UNIFORM_BUFFER, 1, maps_.name());
  splat(water);
  smooth();
  timer.mark("light");
  if (strength(PictureEffectKind::Shadows) > 0) {
    cast_shadows(water);
    timer.mark(traits_of(PictureEffectKind::Shadows).word);
  }
  if (strength(PictureEffectKind::Caustics) > 0) {
    gather_caustics(water);
    timer.mark(traits_of(PictureEffectKind::Caustics).word);
  }
  join();
  timer.mark("light");
}

void FloorLight::bind() const {
  glBindBufferBase(GL_UNIFORM_BUFFER, 1, maps_.name());
  glBindTextureUnit(0, sunlight_);
}

FloorMap FloorLight::read() const {
  FloorMap out;
  out.width = block_.cells[2];
  out.depth = block_.cells[3];
  out.cell_m = block_.floor_grid[0];
  const auto cells = static_cast<std::size_t>(size_of(out.width, out.depth));
  if (strength(PictureEffectKind::Shadows) > 0) {
    std::vector<std::array<float, 2>> words(cells);
    shadow_.read(words.data(), static_cast<std::int64_t>(8 * cells));
    for (const auto& [open, way] : words) {
      out.open.push_back(open);
      out.way_m.push_back(way);
    }
  }
  if (strength(PictureEffectKind::Caustics) > 0) {
    std::vector<std::uint32_t> words(cells);
    caustic_.read(words.data(), static_cast<std::int64_t>(4 * cells));
    for (const std::uint32_t word : words) out.gathered.push_back(static_cast<float>(word) / caustic_units);
  }
  return out;
}

}  // namespace sim
