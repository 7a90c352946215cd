layout(std430, binding = 1) buffer Depth { uint depth_bits[]; };  // of a positive float: ordered like it
layout(std430, binding = 3) buffer Thickness { uint thickness[]; };
layout(std430, binding = 6) buffer Touched { uint touched[]; };  // per particle: see occlusion.glsl

// Bits of the sphere's depth at a pixel, or the largest word where it lies behind `held` or is not met.
uint depth_up_to(uint held, Sphere s, ivec2 pixel, bool subpixel, vec4 grid) {
  const uint behind = 0xffffffffu;
  if (s.nearest > held) return behind;
  const vec2 slope = cell_slope(pixel, grid);
  float entry, leave;
  if (!meets_whole(s, slope, subpixel, entry, leave)) return behind;
  if (s.cut && !subpixel) {
    // Walls only move it back.
    if (floatBitsToUint(entry) > held || !between_walls(s, slope, entry, leave)) return behind;
  }
  return floatBitsToUint(entry);
}

// True when this depth was in front, or level with the front, at this moment. `held` was read there before: a stale
// value can only be too far, and is a safe way round most atomics.
bool splat_depth(Sphere s, ivec2 pixel, bool subpixel, vec4 grid, int at, uint held) {
  const uint bits = depth_up_to(held, s, pixel, subpixel, grid);
  return bits <= held && bits <= atomicMin(depth_bits[at], bits);
}

void splat_thickness(Sphere s, ivec2 cell, bool subpixel, vec4 grid, int row, float units_per_m) {
  const uint units = chord_units(s, cell_slope(cell, grid), subpixel, grid, units_per_m);
  if (units == 0u) return;
  const int at = cell.y * row + cell.x;
  const uint old = atomicAdd(thickness[at], units);
  // Whoever makes it wrap sets it to the largest value, and so does everyone after him.
  if (old + units < old) atomicMax(thickness[at], 0xffffffffu);
}
