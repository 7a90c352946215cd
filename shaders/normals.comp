// Normals from the filtered depth by the smaller of the one-sided differences (van der Laan et al. 2009).
#include "view.glsl"
#include "wet_tiles.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 1) readonly buffer Source { float source[]; };
layout(std430, binding = 2) readonly buffer Radius { float radii[]; };
// Eye space, z to the viewer; w: radius of the particle in front.
layout(std430, binding = 3) writeonly buffer Normals { vec4 normals[]; };

float depth_at(ivec2 pixel) {
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, size.xy))) return no_depth;
  return source[pixel.y * size.x + pixel.x];
}

vec3 point(ivec2 pixel, float depth) { return depth * vec3(slope_at(vec2(pixel) + 0.5), -1.0); }

vec3 tangent(ivec2 pixel, float depth, ivec2 step) {
  const float before = depth_at(pixel - step), after = depth_at(pixel + step);
  if (!is_fluid(before) && !is_fluid(after)) return point(pixel + step, depth) - point(pixel, depth);
  if (is_fluid(after) && (!is_fluid(before) || abs(after - depth) <= abs(depth - before))) {
    return point(pixel + step, after) - point(pixel, depth);
  }
  return point(pixel, depth) - point(pixel - step, before);
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, size.xy)) || is_dry()) return;
  const int at = pixel.y * size.x + pixel.x;
  const float depth = source[at];
  if (!is_fluid(depth)) {
    normals[at] = vec4(0);
    return;
  }
  const vec3 normal = cross(tangent(pixel, depth, ivec2(1, 0)), tangent(pixel, depth, ivec2(0, 1)));
  normals[at] = vec4(normalize(normal), radii[at]);
}
