// Water as the sun sees it: one invocation a particle. The highest place of a ray that is in water, and the length of
// the ray in water. Mirror images beyond the walls that the sun is behind let the water go on there, so that light
// that came in through the glass is the light of a wider pool.
#include "light.glsl"
#include "floor_maps.glsl"
#include "usable.glsl"
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Particles { vec4 particles[]; };
layout(std430, binding = 1) buffer Top { uint top[]; };              // height in 24 bits, radius in 8; 0: no water
layout(std430, binding = 2) buffer Thickness { uint thickness[]; };  // fixed point
uniform uint particle_count;

const float least_cells = 0.75;  // radius of a sphere that meets a cell's middle wherever it is

// Radius in sixteenths of a doubling, over the cell's edge.
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
  const float share = pow(own_radius / radius, 3.0);
  const vec2 middle = (centre.xz - leans * centre.y - maps.surface_grid.xy) / edge;
  const vec2 reach = radius / edge * sqrt(1.0 + leans * leans);
  const ivec2 low = ivec2(clamp(ceil(middle - reach - 0.5), vec2(0.0), vec2(maps.cells.xy)));
  const ivec2 high = ivec2(clamp(floor(middle + reach - 0.5) + 1.0, vec2(0.0), vec2(maps.cells.xy)));
  const uint code = radius_code(own_radius);
  const float a = 1.0 + dot(leans, leans);
  for (int z = low.y; z < high.y; ++z) {
    for (int x = low.x; x < high.x; ++x) {
      const vec2 off = (vec2(x, z) + 0.5 - middle) * edge;
      const float b = dot(off, leans);
      const float square = b * b - a * (dot(off, off) - radius * radius);
      if (square <= 0.0) continue;
      const int at = z * maps.cells.x + x;
      add_thickness(at, share * 2.0 * sqrt(square / a));
      const float height = centre.y + (sqrt(square) - b) / a;
      if (height <= 0.0) continue;
      const uint key = uint(clamp(height / maps.tank.w, 1.0, 16777215.0)) << 8 | code;
      if (key > top[at]) atomicMax(top[at], key);
    }
  }
}

void main() {
  const uint i = gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * 64u) + gl_GlobalInvocationID.x;
  if (i >= particle_count) return;
  const vec4 particle = particles[i];
  if (!is_usable(particle)) return;
  const vec3 at = particle.xyz;
  const vec3 size = maps.tank.xyz;
  if (any(lessThan(at, vec3(-particle.w))) || any(greaterThan(at.xz, size.xz + particle.w))) return;
  for (int image = 0; image < 4; ++image) {
    vec3 centre = at;
    if ((image & 1) != 0) centre.x = 2.0 * size.x - at.x;
    if ((image & 2) != 0) centre.z = 2.0 * size.z - at.z;
    splat(centre, particle.w);
  }
}
