#pragma once
/// G-buffers: depth, normal, thickness and front particle of the fluid at each pixel of a camera, on the
/// host. Independent of GL, so that tests and saliency can use stored G-buffers.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "libsim/exec/gl_buffer_ref.hpp"
#include "libsim/view/camera.hpp"

namespace sim {

/// Arrays hold width * height values (normal: three times as many), row by row from the bottom (as in
/// OpenGL). Depths are positive distances along the view direction in m, +infinity without fluid.
struct GBuffer {
  static constexpr std::uint32_t no_particle = 0xffffffffu;

  int width = 0, height = 0;
  View view;  ///< camera of this picture

  /// Distance of the drawn surface from a particle's place, divided by the particle's radius: that of
  /// splatted spheres; 1 for ellipsoids. In Eq. 8 of ViP-Fluid, particle i with the eye depth z_i > 0 and the
  /// radius r_i at pixel p lies max(0, z_i - depth[p] - radius_scale * r_i) m behind the water's surface.
  float radius_scale = 1;

  std::vector<float> depth;           ///< front of the splatted spheres, not smoothed (Eq. 8)
  std::vector<float> filtered_depth;  ///< after the narrow-range filter
  /// 3 values per pixel: unit normal in eye space (x right, y up, z to the viewer); 0: no fluid. Where foam
  /// covers the water, random normals are mixed in (shaders/composite.comp).
  std::vector<float> normal;
  /// Sum of the chords of all spheres along the ray of the pixel's thickness cell, m, not smoothed. The path
  /// length in water is this sum / (RenderOptions::packing * RenderOptions::radius_scale^3).
  std::vector<float> thickness;
  std::vector<std::uint32_t> front;  ///< index of the front particle, or no_particle
  std::vector<float> radius;         ///< radius of the front particle, m; 0 without fluid
};

/// A picture that is still in the GL buffers into which it was drawn (FluidRenderer::picture), until the
/// renderer draws again. Only the parts of a GBuffer that saliency reads.
struct GlPicture {
  int width = 0, height = 0;
  View view;  ///< camera of this picture
  float radius_scale = 1;
  GlBufferRef depth;   ///< one float per pixel: GBuffer::depth
  GlBufferRef normal;  ///< four floats per pixel: GBuffer::normal and GBuffer::radius
};

/// Writes and reads a versioned binary file. The file is replaced as a whole by a rename. Reading checks
/// magic, version, size and that every array is complete (base::Error).
void write_gbuffer(const std::filesystem::path& path, const GBuffer& gbuffer);
GBuffer read_gbuffer(const std::filesystem::path& path);

/// The bytes of a G-buffer file, for storage inside another file; errors name that file by `place`.
std::string gbuffer_bytes(const GBuffer& gbuffer, const std::string& place);
GBuffer gbuffer_of(std::string_view bytes, const std::string& place);

}  // namespace sim
