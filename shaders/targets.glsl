layout(std430, binding = 1) buffer Depth { uint depth_bits[]; };  // of a positive float: ordered like it
layout(std430, binding = 2) buffer Front { uint front[]; };
layout(std430, binding = 3) buffer Thickness { uint thickness[]; };
layout(std430, binding = 6) buffer Touched { uint touched[]; };  // per particle: see occlusion.glsl

// True when this depth was in front, or level with the front, at this moment.
bool splat_depth(Sphere s, ivec2 pixel, bool subpixel, vec4 grid, int row) {
  float entry, leave;
  if (!meets(s, cell_slope(pixel, grid), subpixel, entry, leave)) return false;
  const uint bits = floatBitsToUint(entry);
  const int at = pixel.y * row + pixel.x;
  // A stale value can only be too far: the plain read is a safe way round most atomics.
  if (bits > depth_bits[at]) return false;
  return bits <= atomicMin(depth_bits[at], bits);
}

void splat_front(Sphere s, ivec2 pixel, bool subpixel, vec4 grid, int row, uint particle) {
  float entry, leave;
  if (!meets(s, cell_slope(pixel, grid), subpixel, entry, leave)) return;
  const int at = pixel.y * row + pixel.x;
  if (floatBitsToUint(entry) == depth_bits[at]) atomicMin(front[at], particle);
}

void splat_thickness(Sphere s, ivec2 cell, bool subpixel, vec4 grid, int row, float units_per_m) {
  const uint units = chord_units(s, cell_slope(cell, grid), subpixel, grid, units_per_m);
  if (units == 0u) return;
  const int at = cell.y * row + cell.x;
  const uint old = atomicAdd(thickness[at], units);
  // Whoever makes it wrap sets it to the largest value, and so does everyone after him.
  if (old + units < old) atomicMax(thickness[at], 0xffffffffu);
}
