// Normals from the filtered nearness. On the plane n . p = d, nearness is n . (slope, -1) / d: its derivatives by the
// two slopes are n.x / d and n.y / d. Each derivative is the one-sided difference with the smaller absolute value (van
// der Laan et al. 2009), or the only one if a neighbour has no water.
#include "view.glsl"
#include "wet_tiles.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 1) readonly buffer Source { float source[]; };
layout(std430, binding = 2) readonly buffer Radius { float radii[]; };
// xyz: normal in eye space, z to the viewer; w: radius of the particle in front, m.
layout(std430, binding = 3) writeonly buffer Normals { vec4 normals[]; };

float nearness_at(ivec2 pixel) {
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, size.xy))) return 0.0;
  return source[pixel.y * size.x + pixel.x];
}

float difference(ivec2 pixel, float centre, ivec2 step) {
  const float before = nearness_at(pixel - step), after = nearness_at(pixel + step);
  const float back = centre - before, forth = after - centre;
  if (before == 0.0) return after == 0.0 ? 0.0 : forth;
  return after == 0.0 || abs(back) < abs(forth) ? back : forth;
}

void main() {
  const ivec2 pixel = wet_pixel();
  if (any(greaterThanEqual(pixel, size.xy))) return;
  const int at = pixel.y * size.x + pixel.x;
  const float centre = source[at];
  if (centre == 0.0) {
    normals[at] = vec4(0);
    return;
  }
  const vec2 by_slope =
      vec2(difference(pixel, centre, ivec2(1, 0)), difference(pixel, centre, ivec2(0, 1))) / rays.xz;
  const vec3 normal = vec3(-by_slope, centre - dot(by_slope, slope_at(vec2(pixel) + 0.5)));
  normals[at] = vec4(normalize(normal), radii[at]);
}
