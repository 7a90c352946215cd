// Paints the sky into a texture: one invocation per texel (shaders/surroundings.glsl has the projection). Clouds are
// value noise on a flat layer, in places that follow from the scene's seed.
#include "light.glsl"
#include "sky.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
layout(rgba8, binding = 0) writeonly uniform image2D sky;
uniform uint seed;

uint scrambled(uint word) {
  word = (word ^ (word >> 16)) * 0x45d9f3bu;
  word = (word ^ (word >> 16)) * 0x45d9f3bu;
  return word ^ (word >> 16);
}

// A value from 0 to 1 that belongs to a corner of the lattice.
float corner(ivec2 at, uint octave) {
  return float(scrambled(uint(at.x) + scrambled(uint(at.y) + scrambled(8u * seed + octave))) >> 8) / 16777216.0;
}

float noise(vec2 p, uint octave) {
  const ivec2 low = ivec2(floor(p));
  const vec2 f = p - vec2(low), s = f * f * (3.0 - 2.0 * f);
  return mix(mix(corner(low, octave), corner(low + ivec2(1, 0), octave), s.x),
             mix(corner(low + ivec2(0, 1), octave), corner(low + ivec2(1, 1), octave), s.x), s.y);
}

// Density of the clouds' layer, 0 to 1: octaves of noise, each twice as fine and half as strong.
float density(vec2 p) {
  float sum = 0.0, strength = 0.5;
  for (uint octave = 0u; octave < 5u; ++octave) {
    sum += strength * noise(p, octave);
    p = mat2(1.6, 1.2, -1.2, 1.6) * p;
    strength *= 0.5;
  }
  return smoothstep(0.40, 0.62, sum);
}

void main() {
  const ivec2 cell = ivec2(gl_GlobalInvocationID.xy), cells = imageSize(sky);
  if (any(greaterThanEqual(cell, cells))) return;
  const vec2 e = 2.0 * (vec2(cell) + 0.5) / vec2(cells) - 1.0;
  const vec2 p = 0.5 * vec2(e.x + e.y, e.x - e.y);
  const vec3 d = normalize(vec3(p.x, 1.0 - abs(p.x) - abs(p.y), p.y));
  const float towards_sun = max(dot(d, sun), 0.0);
  vec3 light = mix(haze, vec3(0.10, 0.26, 0.58), pow(d.y, 0.40));
  light += vec3(1.0, 0.85, 0.6) * (0.22 * pow(towards_sun, 24.0) + 4.0 * pow(towards_sun, 1500.0));
  const vec2 layer = 1.7 * d.xz / (d.y + 0.15);
  const float cloud = density(layer) * smoothstep(0.03, 0.25, d.y);
  // A cloud is bright on the side where less cloud stands before the sun.
  const float lit = clamp(0.75 + 0.6 * (density(layer) - density(layer + 0.22 * sun.xz / sun.y)), 0.0, 1.0);
  light = mix(light, mix(vec3(0.50, 0.55, 0.63), vec3(1.05, 1.03, 1.0), lit) + 0.3 * pow(towards_sun, 24.0), 0.92 * cloud);
  imageStore(sky, cell, vec4(sqrt(light / brightest), 1.0));
}
