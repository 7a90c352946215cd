// Finds the farthest splatted depth in each block of 16 x 16 px; one work group per block.
#include "view.glsl"
#include "occlusion.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 1) readonly buffer Depth { uint depth_bits[]; };
layout(std430, binding = 7) writeonly buffer Blocks { uint farthest[]; };
shared uint far;

void main() {
  if (gl_LocalInvocationIndex == 0u) far = 0u;
  barrier();
  const ivec2 first = ivec2(gl_WorkGroupID.xy) * block_px + ivec2(gl_LocalInvocationID.xy);
  uint own = 0u;
  for (int y = 0; y < block_px; y += int(gl_WorkGroupSize.y)) {
    const ivec2 pixel = first + ivec2(0, y);
    if (all(lessThan(pixel, size.xy))) own = max(own, depth_bits[pixel.y * size.x + pixel.x]);
  }
  atomicMax(far, own);
  barrier();
  if (gl_LocalInvocationIndex == 0u) farthest[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] = far;
}
