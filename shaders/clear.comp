// Clears the buffers of the splat passes: one work group per tile of 16 x 8 px. Depth and front are cleared only in
// tiles with water in the last picture (wet_tiles.comp), because they are still empty in the other tiles. Thickness is
// cleared everywhere: walls do not clip it, so that tiles without water may have thickness too.
#include "view.glsl"
#include "counters.glsl"
#include "wide_list.glsl"
#define LIST_TILES
#include "wet_tiles.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 1) writeonly buffer Depth { float depth[]; };
layout(std430, binding = 2) writeonly buffer Front { uint front[]; };
layout(std430, binding = 3) writeonly buffer Thickness { uint thickness[]; };
layout(std430, binding = 6) readonly buffer Wet { uint wet[]; };

void start_counting() {
  not_finite = outside = beyond = near_crossing = subpixel_count = 0u;
  by_thread = by_group = by_tiles = 0u;
  filter_capped = thickness_full = front_missing = 0u;
  group_items = tile_items = group_next = tile_next = 0u;
  wet_groups = dry_groups = uvec4(0, 1, 1, 0);
}

void main() {
  if (gl_GlobalInvocationID.xy == uvec2(0)) start_counting();
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (all(lessThan(pixel, size.zw))) thickness[pixel.y * size.z + pixel.x] = 0u;
  if (any(greaterThanEqual(pixel, size.xy))) return;
  if ((wet[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] & 1u) == 0u) return;
  const int at = pixel.y * size.x + pixel.x;
  depth[at] = no_depth;
  front[at] = 0xffffffffu;
}
