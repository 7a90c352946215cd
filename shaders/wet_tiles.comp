// Which tiles of 16 x 8 px hold water: one work group a tile. See wet_tiles.glsl.
#include "view.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 1) readonly buffer Depth { float depth[]; };
layout(std430, binding = 5) buffer Wet { uint wet[]; };
shared uint holds_water;

void main() {
  if (gl_LocalInvocationIndex == 0u) holds_water = 0u;
  barrier();
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (all(lessThan(pixel, size.xy)) && is_fluid(depth[pixel.y * size.x + pixel.x])) holds_water = 1u;
  barrier();
  if (gl_LocalInvocationIndex != 0u) return;
  const uint tile = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  wet[tile] = (wet[tile] & 1u) << 1 | holds_water;
}
