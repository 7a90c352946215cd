#pragma once
/// The device buffers of one view, and the destination of a picture in a framebuffer. Internal to the
/// renderer.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libsim/gl/gl_buffer.hpp"
#include "libsim/gl/offscreen.hpp"
#include "libsim/render/fluid_renderer.hpp"
#include "libsim/view/camera.hpp"

namespace sim {

/// All outputs of a view's passes, on grids of width x height px and of the coarser thickness cells.
struct ViewTargets {
  View view;
  int width = 0, height = 0;
  int cells_x = 0, cells_y = 0;
  GlBuffer block;               ///< the shaders' ViewBlock
  GlBuffer depth, front;        ///< splatted depth (float bits), index of the front particle
  GlBuffer radii;               ///< per pixel, radius of the front particle; 0: no particle
  GlBuffer filter_a, filter_b;  ///< nearness, 1 / depth; the filtered result is in filter_a
  GlBuffer normals;
  GlBuffer touched;                   ///< per particle, flags of the splatting, see occlusion.glsl
  GlBuffer blocks;                    ///< farthest depth of each block of pixels
  GlBuffer wide_list;                 ///< particles with large footprints, see wide_list.glsl
  GlBuffer wet;                       ///< flags of tiles that contain water, see wet_tiles.comp
  GlBuffer tiles;                     ///< lists of the tiles with and without water, see wet_tiles.glsl
  GlBuffer thickness;                 ///< sum of the chords of all spheres per cell, fixed point
  GlBuffer thickness_a, thickness_b;  ///< the smoothed result is in thickness_a, in fixed-point units
  GlBuffer foam;                      ///< two words per pixel, see foam.glsl; all 0 between pictures
  GlBuffer shaded, shown;             ///< per pixel: linear light (shaded.glsl), nearness of what it shows
  GlBuffer outlines;                  ///< per pixel, flags of outlines.comp
  GlBuffer outline_tiles;             ///< tiles that outlines touch, see outline_tiles.glsl

  void resize(const View& new_view, int thickness_step, bool with_foam);
  /// Allocates the buffers with an entry per particle for `count` particles.
  void follow(std::int64_t count);

  // Implement the functions of FluidRenderer with the same names. The caller sets a memory barrier between
  // the passes and the reads.
  void read_depth(std::vector<float>& out) const;
  /// radius_scale: GBuffer::radius_scale of the last draw.
  void read_picture(float radius_scale, GBuffer& out) const;
  GBuffer read_gbuffer(float radius_scale, const RenderOptions& options) const;

 private:
  std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }

  std::int64_t room_ = -1;  // number of particles for which the buffers are allocated
};

/// Lets compute shaders store a framebuffer's pixels through image unit 0. Binds the framebuffer's texture if
/// that is RGBA8; otherwise an internal picture, which end() copies. Pixels keep their coordinates. Needs a
/// current context at every call and when destroyed.
class PictureTarget {
 public:
  /// Pixels stored between begin() and end() reach the views' viewports in the framebuffer.
  void begin(unsigned framebuffer, std::span<const View> views);
  void end(unsigned framebuffer, std::span<const View> views) const;

 private:
  bool copies_ = false;
  std::unique_ptr<Offscreen> own_;
};

}  // namespace sim
