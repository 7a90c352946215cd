// The farthest depth of each block of pixels: one invocation a block.
#include "view.glsl"
#include "occlusion.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 1) readonly buffer Depth { uint depth_bits[]; };
layout(std430, binding = 7) writeonly buffer Blocks { uint farthest[]; };

void main() {
  const ivec2 blocks = (size.xy + block_px - 1) / block_px;
  const ivec2 block = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(block, blocks))) return;
  const ivec2 low = block * block_px, high = min(low + block_px, size.xy);
  uint far = 0u;
  for (int y = low.y; y < high.y; ++y) {
    for (int x = low.x; x < high.x; ++x) far = max(far, depth_bits[y * size.x + x]);
  }
  farthest[block.y * blocks.x + block.x] = far;
}
