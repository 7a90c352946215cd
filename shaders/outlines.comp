// Finds outlines: pixels whose right or upper neighbour shows another layer. Depth jumps there, and does not follow
// the slope on either side. Lists the tiles of 16 x 8 px that an outline touches, each once.
#include "view.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 0) readonly buffer Shown { float shown[]; };
#ifdef FOAM
layout(std430, binding = 1) buffer Normals { vec4 normals[]; };
layout(std430, binding = 4) buffer Cover { uint cover[]; };  // share of the pixel that foam covers, and another word
#else
layout(std430, binding = 1) readonly buffer Normals { vec4 normals[]; };
#endif
layout(std430, binding = 2) writeonly buffer Outlines { uint outlines[]; };  // bit 0: to the right; bit 1: above
layout(std430, binding = 5) buffer Wet { uint wet[]; };  // per tile; bit 2: it is listed here
#include "outline_tiles.glsl"

const float least_jump_r = 1.2;  // smallest jump of depth between layers of water, splatted radii
const float least_jump = 0.03;   // the same between obstacles, share of the depth

int index_of(ivec2 pixel) {
  const ivec2 inside = clamp(pixel, ivec2(0), size.xy - 1);
  return inside.y * size.x + inside.x;
}

bool is_outline(ivec2 pixel, ivec2 step, float here, float radius) {
  if (any(greaterThanEqual(pixel + step, size.xy))) return false;
  const float there = shown[index_of(pixel + step)];
  if (here == there) return false;
  if (here == 0.0 || there == 0.0) return true;
  const float nearer = max(here, there);
  const float least = nearer * (radius > 0.0 ? least_jump_r * radius * nearer : least_jump);
  const float jump = there - here;
  if (abs(jump) <= least) return false;
  const float before = shown[index_of(pixel - step)], after = shown[index_of(pixel + 2 * step)];
  const float on_this_side = before > 0.0 ? here - before : 0.0, on_that_side = after > 0.0 ? after - there : 0.0;
  return min(abs(jump - on_this_side), abs(jump - on_that_side)) > least;
}

#ifdef FOAM
uint scrambled(uint word) {
  word = (word ^ (word >> 16)) * 0x45d9f3bu;
  word = (word ^ (word >> 16)) * 0x45d9f3bu;
  return word ^ (word >> 16);
}

// A normal of foamy water for saliency, which reads the G-buffer: the smooth normal mixed with a random one by the
// share `covered`. The random normals are distributed like those over the visible disc of a sphere.
vec3 rough_normal(vec3 smooth_one, int at, float covered) {
  const uint first = scrambled(uint(at)), second = scrambled(first + 1u);
  const float squared = float(first >> 8) / 16777216.0, angle = 6.2831853 * float(second >> 8) / 16777216.0;
  const vec3 bubble = vec3(sqrt(squared) * vec2(cos(angle), sin(angle)), sqrt(1.0 - squared));
  const vec3 mixed = mix(smooth_one, bubble, covered);
  return length(mixed) > 0.1 ? normalize(mixed) : smooth_one;
}

// Leaves the normals to saliency, and the foam's sums at 0 for the next picture.
void leave_foam(int at) {
  const float covered = uintBitsToFloat(cover[2 * at]);
  cover[2 * at] = cover[2 * at + 1] = 0u;
  if (covered > 0.0) normals[at].xyz = rough_normal(normals[at].xyz, at, covered);
}
#endif

void list_tile(uvec2 tile) {
  if (any(greaterThanEqual(tile, gl_NumWorkGroups.xy))) return;
  const uint at = tile.y * gl_NumWorkGroups.x + tile.x;
  if ((atomicOr(wet[at], 4u) & 4u) == 0u) tiles[atomicAdd(tile_groups.x, 1u)] = at;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, size.xy))) return;
  const int at = pixel.y * size.x + pixel.x;
  const float here = shown[at], radius = normals[at].w * origin.w;
  const uint bits = uint(is_outline(pixel, ivec2(1, 0), here, radius)) |
                    uint(is_outline(pixel, ivec2(0, 1), here, radius)) << 1;
  outlines[at] = bits;
#ifdef FOAM
  leave_foam(at);
#endif
  if (bits == 0u) return;
  const uvec2 tile = gl_WorkGroupID.xy;
  list_tile(tile);
  if (gl_LocalInvocationID.x == 15u && (bits & 1u) != 0u) list_tile(tile + uvec2(1, 0));
  if (gl_LocalInvocationID.y == 7u && (bits & 2u) != 0u) list_tile(tile + uvec2(0, 1));
}
