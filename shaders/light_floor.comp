// Sunlight on the floor relative to that without water and obstacles: the product of the scene's picture effects
// (shadows, caustics). One invocation per cell of the floor map.
#include "light.glsl"
#include "floor_maps.glsl"
#ifdef SHADOWS
layout(std430, binding = 0) readonly buffer Shadow { vec2 shadow[]; };
#endif
#ifdef CAUSTICS
#include "caustic_units.glsl"
layout(std430, binding = 1) readonly buffer Caustic { uint caustic[]; };
#endif
layout(local_size_x = 16, local_size_y = 8) in;
layout(rgba16f, binding = 0) writeonly uniform image2D sunlight;

void main() {
  const ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(cell, maps.cells.zw))) return;
  const int at = cell.y * maps.cells.z + cell.x;
  vec3 share = vec3(1.0);
#ifdef SHADOWS
  share *= mix(vec3(1.0), shadow[at].x * exp(-maps.absorption.rgb * shadow[at].y), maps.strength.x);
#endif
#ifdef CAUSTICS
  share *= mix(1.0, float(caustic[at]) / caustic_units, maps.strength.y);
#endif
  imageStore(sunlight, cell, vec4(share, 1.0));
}
