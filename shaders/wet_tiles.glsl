// The tiles of 16 x 8 px in two lists. Wet tiles hold water or held it in the last picture; passes over water leave out
// the others, whose buffers hold no water. A pass runs one work group per tile of a list.
#ifdef LIST_TILES
#define tiles_access
#else
#define tiles_access readonly
#endif
layout(std430, binding = 8) tiles_access buffer Tiles {
  uvec4 wet_groups, dry_groups;  // xyz: numbers of work groups, for indirect dispatches
  uint listed_tiles[];           // wet ones from the first word on, dry ones from the last word backwards
};

uvec2 tile_counts() { return uvec2(size.xy + ivec2(15, 7)) / uvec2(16, 8); }
uint last_tile() { return tile_counts().x * tile_counts().y - 1u; }

// The invocation's pixel in its work group's tile of a list.
ivec2 pixel_of(uint tile) {
  const uint across = tile_counts().x;
  return ivec2(tile % across, tile / across) * ivec2(16, 8) + ivec2(gl_LocalInvocationID.xy);
}
ivec2 wet_pixel() { return pixel_of(listed_tiles[gl_WorkGroupID.x]); }
ivec2 dry_pixel() { return pixel_of(listed_tiles[last_tile() - gl_WorkGroupID.x]); }
