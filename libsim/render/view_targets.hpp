#pragma once
/// The device buffers of one view. Internal to the renderer.

#include <cstdint>
#include <vector>

#include "libsim/render/fluid_renderer.hpp"
#include "libsim/render/gl_buffer.hpp"

namespace sim {

/// Everything that a view's passes write, on grids of width x height px and of the coarser thickness cells.
struct ViewTargets {
  View view;
  int width = 0, height = 0;
  int cells_x = 0, cells_y = 0;
  GlBuffer block;               ///< the shaders' ViewBlock
  GlBuffer depth, front;        ///< splatted depth (float bits), particle in front
  GlBuffer radii;               ///< of the particle in front; 0: none
  GlBuffer filter_a, filter_b;  ///< nearness, 1 / depth; filtered it ends in filter_a
  GlBuffer normals;
  GlBuffer touched;                   ///< a word a particle: what occlusion.glsl remembers of it
  GlBuffer blocks;                    ///< farthest depth of each block of pixels
  GlBuffer wide_list;                 ///< particles with large footprints, see wide_list.glsl
  GlBuffer wet;                       ///< which tiles hold water, see wet_tiles.glsl
  GlBuffer thickness;                 ///< fixed point
  GlBuffer thickness_a, thickness_b;  ///< smoothed thickness ends in thickness_a, in fixed-point units
  GlBuffer foam;                      ///< two words a pixel, see foam.glsl; empty between pictures

  void resize(const View& new_view, int thickness_step, bool with_foam);
  /// Makes room for `count` particles.
  void follow(std::int64_t count);

  // See FluidRenderer; a barrier must lie between the passes and these.
  void read_depth(std::vector<float>& out) const;
  void read_picture(const RenderOptions& options, GBuffer& out) const;
  GBuffer read_gbuffer(const RenderOptions& options) const;

 private:
  std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }

  std::int64_t room_ = -1;  // particles
};

}  // namespace sim
