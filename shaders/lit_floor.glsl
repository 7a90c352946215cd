// How bright the floor is where picture effects take sunlight away or gather it; 1 without water and obstacles.
#include "floor_maps.glsl"
#ifdef SHADOWS
layout(std430, binding = 5) readonly buffer Shadow { vec2 shadow[]; };
#endif
#ifdef CAUSTICS
#include "caustic_units.glsl"
layout(std430, binding = 6) readonly buffer Caustic { uint caustic[]; };
#endif

const float sun_share = 0.7;  // of the floor's light; the rest comes from the sky

// Sunlight on a cell of the floor, over that without water.
vec3 sunlight_on(ivec2 cell) {
  const ivec2 inside = clamp(cell, ivec2(0), maps.cells.zw - 1);
  const int at = inside.y * maps.cells.z + inside.x;
  vec3 out_light = vec3(1.0);
#ifdef SHADOWS
  out_light = mix(out_light, shadow[at].x * exp(-absorption.rgb * shadow[at].y), maps.strength.x);
#endif
#ifdef CAUSTICS
  out_light *= mix(1.0, float(caustic[at]) / caustic_units, maps.strength.y);
#endif
  return out_light;
}

vec3 sunlight_near(vec2 place) {
  const vec2 g = place / maps.floor_grid.x - 0.5;
  const ivec2 low = ivec2(floor(g));
  const vec2 f = g - vec2(low);
  return mix(mix(sunlight_on(low), sunlight_on(low + ivec2(1, 0)), f.x),
             mix(sunlight_on(low + ivec2(0, 1)), sunlight_on(low + ivec2(1, 1)), f.x), f.y);
}

vec3 floor_light(vec2 place) { return 1.0 - sun_share + sun_share * sunlight_near(place); }
