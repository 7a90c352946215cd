// Brightness of the floor under picture effects, relative to that without water and obstacles.
#include "floor_maps.glsl"
layout(binding = 0) uniform sampler2D light_map;  // of light_floor.comp

// Mean brightness at point p over a footprint of `width` m perpendicular to the ray d.
vec3 floor_light(vec3 p, vec3 d, float width) {
  const vec2 size = vec2(maps.cells.zw) * maps.floor_grid.x;
  const float cells = width * inversesqrt(max(-d.y, 0.08)) / maps.floor_grid.x;
  return textureLod(light_map, p.xz / size, log2(max(cells, 1.0))).rgb;
}
