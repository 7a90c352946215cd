// Splats foam: one invocation per diffuse particle adds a soft disc in front of the water's surface or below it.
#include "view.glsl"
#include "foam.glsl"
#include "usable.glsl"
#ifdef OBSTACLES
#include "room.glsl"
#endif
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Foam { vec4 foam[]; };  // x, y, z, radius in m; radius 0: unused entry
layout(std430, binding = 1) readonly buffer Nearness { float nearness[]; };
layout(std430, binding = 2) readonly buffer Normals { vec4 normals[]; };  // w: radius of the front water particle, m
layout(std430, binding = 3) buffer Cover { uint cover[]; };              // two words per pixel, see foam.glsl
uniform uint foam_count;

const float middle_depth = 1.2;   // optical depth at a disc's centre
const float most_px = 48.0;       // radius of the largest disc, px
const float dimmed_per_m = 0.7;   // attenuation by the water above the foam, 1/m

// Distance of foam at `depth` below the water's surface, along the surface's normal, m; 0 above it or without water.
// `on_top`: share of the foam that counts as on the surface, from 1 at one particle radius below it to 0 at two: the
// surface is drawn too high, because splatted spheres are larger than particles.
float below_surface(float depth, ivec2 pixel, int at, out float on_top) {
  on_top = 1.0;
  if (nearness[at] <= 0.0) return 0.0;
  const vec4 normal = normals[at];
  const vec3 ray = vec3(slope_at(vec2(pixel) + 0.5), -1.0);
  const float below = (depth - 1.0 / nearness[at]) * max(-dot(ray, normal.xyz), 0.2);
  on_top = 1.0 - smoothstep(1.0, 2.0, below / max(normal.w, 1e-6));
  return max(below, 0.0);
}

void lay(float optical_depth, float depth, ivec2 pixel) {
  const int at = pixel.y * size.x + pixel.x;
  float on_top;
  const float below = below_surface(depth, pixel, at, on_top);
  const uint front = uint(optical_depth * on_top * foam_units + 0.5);
  const uint behind = uint(optical_depth * (1.0 - on_top) * exp(-dimmed_per_m * below) * foam_units + 0.5);
  if (front > 0u) atomicAdd(cover[2 * at], front);
  if (behind > 0u) atomicAdd(cover[2 * at + 1], behind);
}

void main() {
  const uint i = gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * 64u) + gl_GlobalInvocationID.x;
  if (i >= foam_count) return;
  const vec4 particle = foam[i];
  if (!is_usable(particle)) return;
  const vec3 eye = (world_to_eye * vec4(particle.xyz, 1.0)).xyz;
  const float depth = -eye.z;
  if (depth < origin.z + particle.w) return;
#ifdef OBSTACLES
  const vec3 from = eye_to_world[3].xyz, way = particle.xyz - from;
  if (meet_obstacles(from, normalize(way)).at < length(way)) return;
#endif
  const vec2 centre = (eye.xy / depth - rays.yw) / rays.xz;
  // A disc with a radius of 1 px covers at least one pixel's centre. Smaller discs are drawn with this radius, and
  // their optical depth is reduced by the ratio of the areas.
  const float true_px = particle.w / (depth * rays.x);
  const float radius_px = clamp(true_px, 1.0, most_px);
  if (any(lessThan(centre, vec2(-radius_px))) || any(greaterThan(centre, vec2(size.xy) + radius_px))) return;
  const float thickness = middle_depth * min(true_px * true_px, 1.0);
  const ivec2 low = max(ivec2(floor(centre - radius_px)), ivec2(0));
  const ivec2 high = min(ivec2(ceil(centre + radius_px)), size.xy);
  for (int y = low.y; y < high.y; ++y) {
    for (int x = low.x; x < high.x; ++x) {
      const vec2 off = (vec2(x, y) + 0.5 - centre) / radius_px;
      const float inside = 1.0 - dot(off, off);
      if (inside > 0.0) lay(thickness * inside, depth, ivec2(x, y));
    }
  }
}
