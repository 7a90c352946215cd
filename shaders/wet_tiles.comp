// Lists the tiles of 16 x 8 px (wet_tiles.glsl); one work group per tile. Also writes the inputs of the depth filter:
// nearness, and the radius of the particle in front of each pixel.
#include "view.glsl"
#include "counters.glsl"
#define LIST_TILES
#include "wet_tiles.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 0) readonly buffer Particles { vec4 particles[]; };
layout(std430, binding = 1) readonly buffer Depth { float depth[]; };
layout(std430, binding = 2) readonly buffer Front { uint front[]; };
layout(std430, binding = 3) writeonly buffer Radius { float radii[]; };  // 0: no water, or no particle in front
layout(std430, binding = 5) buffer Wet { uint wet[]; };  // per tile; bit 0: it holds water, bit 1: it held water before
layout(std430, binding = 6) writeonly buffer Nearness { float nearness[]; };
shared uint holds_water, before;

void main() {
  const uint tile = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (gl_LocalInvocationIndex == 0u) {
    holds_water = 0u;
    before = wet[tile];
  }
  barrier();
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  const bool inside = all(lessThan(pixel, size.xy));
  const int at = pixel.y * size.x + pixel.x;
  const bool fluid = inside && is_fluid(depth[at]);
  if (fluid) holds_water = 1u;
  barrier();
  const uint state = (before & 1u) << 1 | holds_water;
  if (inside && state != 0u) {
    float radius = 0.0;
    if (fluid && front[at] != 0xffffffffu) radius = particles[front[at]].w;
    if (fluid && radius == 0.0) atomicAdd(front_missing, 1u);
    radii[at] = radius;
    nearness[at] = nearness_of(depth[at]);
  }
  if (gl_LocalInvocationIndex != 0u) return;
  wet[tile] = state;
  if (state != 0u) {
    listed_tiles[atomicAdd(wet_groups.x, 1u)] = tile;
  } else {
    listed_tiles[last_tile() - atomicAdd(dry_groups.x, 1u)] = tile;
  }
}
