layout(std430, binding = 1) buffer Depth { uint depth_bits[]; };  // floats > 0; their bits have the same order
layout(std430, binding = 3) buffer Thickness { uint thickness[]; };
layout(std430, binding = 6) buffer Touched { uint touched[]; };  // per particle: see occlusion.glsl

// Bits of the sphere's depth at a pixel; 0xffffffff if the ray misses the sphere. The result may also be 0xffffffff
// if the depth lies behind `held`.
uint depth_up_to(uint held, Sphere s, ivec2 pixel, bool subpixel, vec4 grid) {
  const uint behind = 0xffffffffu;
  if (s.nearest > held) return behind;
  const vec2 slope = cell_slope(pixel, grid);
  float entry, leave;
  if (!meets_whole(s, slope, subpixel, entry, leave)) return behind;
  if (s.cut && !subpixel) {
    // Clipping by walls only increases the depth.
    if (floatBitsToUint(entry) > held || !between_walls(s, slope, entry, leave)) return behind;
  }
  return floatBitsToUint(entry);
}

// Lowers the pixel's depth to the sphere's; true if the sphere was not behind it. `held` is the pixel's depth, read
// earlier: a stale value can only be too far, so that the comparison with it safely avoids most atomics.
bool splat_depth(Sphere s, ivec2 pixel, bool subpixel, vec4 grid, int at, uint held) {
  const uint bits = depth_up_to(held, s, pixel, subpixel, grid);
  return bits <= held && bits <= atomicMin(depth_bits[at], bits);
}

void splat_thickness(Sphere s, ivec2 cell, bool subpixel, vec4 grid, int row, float units_per_m) {
  const uint units = chord_units(s, cell_slope(cell, grid), subpixel, grid, units_per_m);
  if (units == 0u) return;
  const int at = cell.y * row + cell.x;
  const uint old = atomicAdd(thickness[at], units);
  // On overflow the sum becomes the largest value. Each later addition overflows too and restores this value.
  if (old + units < old) atomicMax(thickness[at], 0xffffffffu);
}
