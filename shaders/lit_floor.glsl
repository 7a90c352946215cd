// How bright the floor is where picture effects take sunlight away or gather it; 1 without water and obstacles.
#include "floor_maps.glsl"
layout(binding = 0) uniform sampler2D sunlight;  // on the floor, over that without both

const float sun_share = 0.7;  // of the floor's light; the rest comes from the sky

// Over a footprint of `width` m across the ray.
vec3 floor_light(vec3 p, vec3 d, float width) {
  const vec2 size = vec2(maps.cells.zw) * maps.floor_grid.x;
  const float cells = width * inversesqrt(max(-d.y, 0.08)) / maps.floor_grid.x;
  return 1.0 - sun_share + sun_share * textureLod(sunlight, p.xz / size, log2(max(cells, 1.0))).rgb;
}
