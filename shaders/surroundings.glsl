// What surrounds the tank, as linear light: sky and paved ground, or with ROOM a hall with windows and lamps. Include
// this file after light.glsl.
uniform mat4 hall;  // column 0: xyz low corner, m; column 1: xyz high corner, m; column 2: 4 values of the seed, 0 to 1

// Share of a footprint of `width` m that a strip of half width `half_m` covers; its middle is `away` m off.
float strip(float away, float half_m, float width) {
  const float w = max(width, 1e-4);
  return max(min(away + half_m, 0.5 * w) - max(away - half_m, -0.5 * w), 0.0) / w;
}

// The same for strips that repeat every `period` m, with a middle at 0 (box filter, exact).
float covered_before(float x, float half_m) { return 2.0 * half_m * floor(x) + min(fract(x) , 2.0 * half_m); }
float strips(float x, float half_m, float period, float width) {
  const float w = max(width, 1e-4) / period, low = x / period + half_m / period - 0.5 * w;
  return (covered_before(low + w, half_m / period) - covered_before(low, half_m / period)) / w;
}
vec2 strips(vec2 p, float half_m, float period, vec2 width) {
  return vec2(strips(p.x, half_m, period, width.x), strips(p.y, half_m, period, width.y));
}

// Extents along x and z of a pixel's footprint on a level floor, m; `width`: extent across the ray d.
vec2 on_floor(vec3 d, float width) {
  const float down = max(abs(d.y), 0.002);
  const vec2 along = d.xz * d.xz / max(dot(d.xz, d.xz), 1e-9);
  return width * sqrt(along / (down * down) + (1.0 - along));
}

#ifdef ROOM
// The hall. `width`: extent of the pixel's footprint across the ray per m of way; `travelled`: way before o, m.
vec3 surroundings(vec3 o, vec3 d, float width_per_m, float travelled) {
  const vec3 low = hall[0].xyz, high = hall[1].xyz, seeds = hall[2].xyz;
  const vec3 safe = mix(d, vec3(1e-6), lessThan(abs(d), vec3(1e-6)));
  const vec3 far = (mix(low, high, greaterThan(safe, vec3(0.0))) - o) / safe;
  const float at = max(min(far.x, min(far.y, far.z)), 0.0);
  const vec3 p = o + at * d;
  const float width = width_per_m * (travelled + at);
  const float tall = high.y - low.y, up = clamp((p.y - low.y) / tall, 0.0, 1.0);
  if (far.y <= at && d.y < 0.0) {
    const vec2 plank = strips(p.xz, 0.006 * tall, 0.08 * tall, on_floor(d, width));
    return mix(vec3(0.32, 0.22, 0.13), vec3(0.14, 0.09, 0.05), 0.8 * plank.x);
  }
  if (far.y <= at) {
    const vec2 wide = on_floor(d, width), from = p.xz - low.xz + seeds.xy * tall;
    const float lamp = strips(from.x, 0.20 * tall, 0.9 * tall, wide.x) * strips(from.y, 0.05 * tall, 0.6 * tall, wide.y);
    return mix(vec3(0.50, 0.49, 0.46), vec3(3.0, 2.9, 2.6), lamp);
  }
  const bool across_x = far.x <= far.z;
  const float along = (across_x ? p.z - low.z : p.x - low.x) + seeds.z * tall;
  const float wide = width / max(across_x ? abs(d.x) : abs(d.z), 0.02);
  vec3 wall = mix(vec3(0.36, 0.33, 0.29), vec3(0.52, 0.50, 0.46), up);
  wall = mix(wall, vec3(0.17, 0.14, 0.12), strip(p.y - low.y, 0.045 * tall, width));
  if (across_x == (seeds.x > 0.5)) {  // the walls with windows
    const float opening = strips(along, 0.22 * tall, 0.7 * tall, wide) * strip(up * tall - 0.55 * tall, 0.25 * tall, width);
    const float bars = max(strips(along, 0.012 * tall, 0.7 * tall, wide), strip((up - 0.6) * tall, 0.012 * tall, width));
    const vec3 outside = mix(vec3(0.75, 0.85, 0.80), vec3(1.35, 1.55, 1.75), smoothstep(0.35, 0.65, up));
    wall = mix(wall, mix(outside, vec3(0.20, 0.19, 0.18), bars), opening);
  } else {  // pictures that hang in a row
    wall = mix(wall, vec3(0.16, 0.24, 0.30), strips(along, 0.12 * tall, 0.9 * tall, wide) * strip((up - 0.5) * tall, 0.09 * tall, width));
  }
  return wall;
}
#else
#include "sky.glsl"
layout(binding = 1) uniform sampler2D sky;  // upper half of all directions; octahedral, y up

const float texel = 0.0055;  // mean angle between neighbouring texels of the sky, rad

vec3 surroundings(vec3 o, vec3 d, float width_per_m, float travelled) {
  if (d.y > 0.0) {
    const vec2 p = d.xz / (abs(d.x) + abs(d.z) + d.y);
    const float level = log2(max(width_per_m / texel, 1.0));
    const vec3 root = textureLod(sky, 0.5 + 0.5 * vec2(p.x + p.y, p.x - p.y), level).rgb;
    return brightest * root * root;
  }
  const float at = max(o.y, 0.0) / max(-d.y, 1e-4);
  const vec3 p = o + at * d;
  const vec2 joint = strips(p.xz, 0.03, 2.0, on_floor(d, width_per_m * (travelled + at)));
  const vec3 ground = mix(vec3(0.33, 0.32, 0.30), vec3(0.20, 0.20, 0.19), max(joint.x, joint.y));
  return mix(haze, ground, exp(-0.012 * at));
}
#endif
