#pragma once
/// The picture effects of a scene (shadows, caustics): maps of the light on the floor, shared by all views.
/// Internal to the renderer.

#include <array>
#include <cstdint>

#include "libsim/gl/gl_buffer.hpp"
#include "libsim/gl/gl_program.hpp"
#include "libsim/render/fluid_renderer.hpp"
#include "libsim/render/pass_timer.hpp"

namespace sim {

/// Strength of a picture effect. Where the scene does not list shadows, [light] decides on them.
float floor_strength(const Scene& scene, PictureEffectKind kind);
/// True if the scene needs FloorLight: shadows or caustics have a strength above 0.
bool lights_the_floor(const Scene& scene);
/// Inputs of FloorLight's passes.
struct FloorWater {
  unsigned particles = 0;  ///< GL buffer of RenderParticle
  std::int64_t count = 0;
  unsigned obstacles = 0;       ///< GL buffer of obstacle poses (shaders/obstacles.glsl); 0: none
  unsigned obstacle_grids = 0;  ///< GL buffer of meshes (shaders/obstacle_meshes.glsl); 0: none
  int obstacle_count = 0;
};

/// Created only if a scene lists a picture effect with a strength above 0. Needs a current context at every
/// call and when destroyed.
class FloorLight {
 public:
  FloorLight(const Scene& scene, const RenderOptions& options);
  ~FloorLight();
  FloorLight(const FloorLight&) = delete;
  FloorLight& operator=(const FloorLight&) = delete;

  void compute(const FloorWater& water, PassTimer& timer);
  /// Binds the maps for shaders that show the floor (shaders/lit_floor.glsl).
  void bind() const;
  FloorMap read() const;

 private:
  /// std140 layout of shaders/floor_maps.glsl.
  struct Block {
    std::array<float, 4> tank;
    std::array<std::int32_t, 4> cells;
    std::array<float, 4> surface_grid, floor_grid, strength, absorption;
  };

  float strength(PictureEffectKind kind) const { return block_.strength[static_cast<std::size_t>(kind)]; }
  void splat(const FloorWater& water);
  void smooth();
  void cast_shadows(const FloorWater& water);
  void gather_caustics(const FloorWater& water);
  void join();

  Block block_;
  GlProgram splat_, splat_images_, smooth_first_, smooth_second_, shadows_, caustics_, join_;
  GlBuffer maps_;                         // the Block
  GlBuffer top_, thickness_;              // surface of the particles
  GlBuffer image_top_, image_thickness_;  // surface of their mirror images beyond the walls
  GlBuffer surface_a_, surface_b_;        // both surfaces joined; a: smoothed along x, b: also along z
  GlBuffer shadow_, caustic_;             // floor maps of the effects that the scene lists
  unsigned sunlight_ = 0;                 // texture of the combined floor maps
  unsigned format_ = 0;                   // of its cells
};

}  // namespace sim
