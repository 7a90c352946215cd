// The water's surface along rays of sunlight: one invocation per particle. Each ray gets the height of its highest
// point in water, and its length in water. IMAGES: splats the mirror images of the pool's particles beyond the walls
// instead, so that light through the glass is that of a pool which continues beyond the walls.
#include "light.glsl"
#include "floor_maps.glsl"
#include "usable.glsl"
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Particles { vec4 particles[]; };
layout(std430, binding = 1) buffer Top { uint top[]; };              // height in 24 bits, radius in 8; 0: no water
layout(std430, binding = 2) buffer Thickness { uint thickness[]; };  // length of the ray in water, fixed point
#ifdef IMAGES
layout(std430, binding = 3) readonly buffer OwnTop { uint own_top[]; };  // the surface without mirror images
layout(std430, binding = 4) readonly buffer OwnThickness { uint own_thickness[]; };
#endif
uniform uint particle_count;

const float least_cells = 0.75;  // smallest splatted radius, cells: covers a cell centre at any position

// Radius as 8 bits: 16 log2(radius / edge of a cell) + 128.
uint radius_code(float radius) {
  return uint(clamp(16.0 * log2(radius / maps.surface_grid.z) + 128.5, 1.0, 255.0));
}

void add_thickness(int at, float length_m) {
  const uint units = uint(min(length_m, 1e3) * maps.floor_grid.y + 0.5);
  const uint old = atomicAdd(thickness[at], units);
  if (old + units < old) atomicMax(thickness[at], 0xffffffffu);
}

void splat(vec3 centre, float own_radius) {
  const float edge = maps.surface_grid.z;
  const float radius = max(own_radius * maps.surface_grid.w, least_cells * edge);
  const float narrowed = own_radius / radius;
  const vec2 middle = (centre.xz - leans * centre.y - maps.surface_grid.xy) / edge;
  const vec2 reach = radius / edge * sqrt(1.0 + leans * leans);
  const ivec2 low = ivec2(clamp(ceil(middle - reach - 0.5), vec2(0.0), vec2(maps.cells.xy)));
  const ivec2 high = ivec2(clamp(floor(middle + reach - 0.5) + 1.0, vec2(0.0), vec2(maps.cells.xy)));
  const uint code = radius_code(own_radius);
  const float volume_share = narrowed * narrowed * narrowed;
  const float a = 1.0 + dot(leans, leans);
  for (int z = low.y; z < high.y; ++z) {
    for (int x = low.x; x < high.x; ++x) {
      const vec2 off = (vec2(x, z) + 0.5 - middle) * edge;
      const float b = dot(off, leans);
      const float square = b * b - a * (dot(off, off) - radius * radius);
      if (square <= 0.0) continue;
      const int at = z * maps.cells.x + x;
      add_thickness(at, volume_share * 2.0 * sqrt(square / a));
      const float height = centre.y + (sqrt(square) - b) / a;
      if (height <= 0.0) continue;
      const uint key = uint(clamp(height / maps.tank.w, 1.0, 16777215.0)) << 8 | code;
      if (key > top[at]) atomicMax(top[at], key);
    }
  }
}

#ifdef IMAGES
// True if the ray of sunlight through a particle is in water for more than half of its path from the surface to the
// floor or wall. Other particles, of spray and jets, get no mirror image: it would darken the floor a second time.
bool is_in_pool(vec4 particle) {
  const vec2 through = particle.xz - leans * particle.y;
  const ivec2 cell = ivec2(floor((through - maps.surface_grid.xy) / maps.surface_grid.z));
  if (any(lessThan(cell, ivec2(0))) || any(greaterThanEqual(cell, maps.cells.xy))) return false;
  const int at = cell.y * maps.cells.x + cell.x;
  const vec2 leaves = -through / leans;  // heights at which the ray crosses the walls x = 0 and z = 0
  const float height = float(own_top[at] >> 8) * maps.tank.w - max(max(leaves.x, leaves.y), 0.0);
  return float(own_thickness[at]) * maps.floor_grid.z * sun.y > 0.5 * max(height, particle.w);
}
#endif

void main() {
  const uint i = gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * 64u) + gl_GlobalInvocationID.x;
  if (i >= particle_count) return;
  const vec4 particle = particles[i];
  if (!is_usable(particle)) return;
  const vec3 at = particle.xyz;
  const vec3 size = maps.tank.xyz;
  if (any(lessThan(at, vec3(-particle.w))) || any(greaterThan(at.xz, size.xz + particle.w))) return;
#ifdef IMAGES
  if (!is_in_pool(particle)) return;
  const vec2 end = maps.surface_grid.xy + vec2(maps.cells.xy) * maps.surface_grid.z;
  const bvec2 beyond = lessThan(2.0 * size.xz - at.xz - leans * at.y - 3.0 * particle.w, end);
  const bvec2 before = lessThan(at.xz + leans * at.y - 3.0 * particle.w, -maps.surface_grid.xy);
  for (int z = before.y ? -1 : 0; z <= (beyond.y ? 1 : 0); ++z) {
    for (int x = before.x ? -1 : 0; x <= (beyond.x ? 1 : 0); ++x) {
      if (x == 0 && z == 0) continue;
      const vec2 place = mix(at.xz, mix(2.0 * size.xz - at.xz, -at.xz, lessThan(vec2(x, z), vec2(0.0))),
                             notEqual(ivec2(x, z), ivec2(0)));
      splat(vec3(place.x, at.y, place.y), particle.w);
    }
  }
#else
  splat(at, particle.w);
#endif
}
