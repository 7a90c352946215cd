// One pass, along x or z, of a Gaussian filter over the surface map. A cell holds, in m: x height of the surface above
// the floor, y radius of the particles there, z length of the ray in water; x and y are 0 without water. Two cells on
// opposite sides of the centre count together, and only if both have water and their mean height is close to the
// centre's. Planes are therefore preserved, and a pool does not mix with spray above it. FIRST: the input is the splats
// of light_splat.comp.
#include "light.glsl"
#include "floor_maps.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
#ifdef FIRST
layout(std430, binding = 0) readonly buffer Top { uint top[]; };
layout(std430, binding = 1) readonly buffer Thickness { uint thickness[]; };
layout(std430, binding = 3) readonly buffer ImageTop { uint image_top[]; };
layout(std430, binding = 4) readonly buffer ImageThickness { uint image_thickness[]; };
#else
layout(std430, binding = 0) readonly buffer Source { vec4 source[]; };
#endif
layout(std430, binding = 2) writeonly buffer Target { vec4 target[]; };
uniform ivec2 direction;

const int most_taps = 24;
const vec2 narrow = vec2(2.0, 4.0);  // height difference, particle radii: x full weight up to it, y none from it

vec4 cell_at(int at) {
#ifdef FIRST
  const uint key = max(top[at], image_top[at]);
  const float length_m = (float(thickness[at]) + float(image_thickness[at])) * maps.floor_grid.z;
  const float radius = key == 0u ? 0.0 : maps.surface_grid.z * exp2((float(key & 255u) - 128.0) / 16.0);
  return vec4(float(key >> 8) * maps.tank.w, radius, length_m, 0.0);
#else
  return source[at];
#endif
}

void main() {
  const ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(cell, maps.cells.xy))) return;
  const int at = cell.y * maps.cells.x + cell.x;
  const vec4 middle = cell_at(at);
  target[at] = middle;
  if (middle.y == 0.0) return;
  const float sigma = max(maps.floor_grid.w * middle.y / maps.surface_grid.z, 1.0);
  const float reach = 3.0 * sigma;
  const int taps = min(int(ceil(reach)), most_taps);
  const float stride = max(reach / float(taps), 1.0);
  const ivec2 room = min(cell, maps.cells.xy - 1 - cell);
  const int most = direction.x == 1 ? room.x : room.y;
  const int jump = direction.x == 1 ? 1 : maps.cells.x;
  vec3 sum = middle.xyz;
  float weights = 1.0;
  for (int k = 1; k <= taps; ++k) {
    const int away = int(float(k) * stride + 0.5);
    if (away > most) break;
    const vec4 before = cell_at(at - away * jump), after = cell_at(at + away * jump);
    if (before.y == 0.0 || after.y == 0.0) continue;
    const vec3 mean = 0.5 * (before.xyz + after.xyz);
    const float off = abs(mean.x - middle.x) / middle.y;
    const float near = exp(-0.5 * float(away * away) / (sigma * sigma));
    const float w = 2.0 * near * (1.0 - smoothstep(narrow.x, narrow.y, off));
    sum += w * mean;
    weights += w;
  }
  target[at] = vec4(sum / weights, 0.0);
}
