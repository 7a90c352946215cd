// Light on the floor relative to that without water and obstacles. Sunlight is the product of the scene's picture
// effects (shadows, caustics). Light of the sky is even. The water above the floor absorbs both. One invocation per cell
// of the floor map.
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
layout(CELLS, binding = 0) writeonly uniform image2D floor_light;

const float sun_share = 0.7;  // share of the floor's light from the sun; the rest is from the sky

#ifdef CAUSTICS
// Light that caustics.comp gathered around a cell. The mean over neighbours, of weights 1, 2, 1 along each axis, takes
// out the pattern of single cells that slanted pieces of surface leave there.
float gathered(ivec2 cell) {
  float sum = 0.0;
  for (int k = 0; k < 9; ++k) {
    const ivec2 aside = ivec2(k % 3, k / 3) - 1, near = clamp(cell + aside, ivec2(0), maps.cells.zw - 1);
    sum += float((2 - abs(aside.x)) * (2 - abs(aside.y))) * float(caustic[near.y * maps.cells.z + near.x]);
  }
  return sum / (16.0 * caustic_units);
}
#endif

void main() {
  const ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(cell, maps.cells.zw))) return;
  const int at = cell.y * maps.cells.z + cell.x;
  vec3 from_sun = vec3(1.0), from_sky = vec3(1.0);
#ifdef SHADOWS
  const vec3 kept = exp(-maps.absorption.rgb * shadow[at].y);
  from_sun = mix(vec3(1.0), shadow[at].x * kept, maps.strength.x);
  from_sky = mix(vec3(1.0), kept, maps.strength.x);
#endif
#ifdef CAUSTICS
  from_sun *= mix(1.0, gathered(cell), maps.strength.y);
#endif
  imageStore(floor_light, cell, vec4(mix(from_sky, from_sun, sun_share), 1.0));
}
