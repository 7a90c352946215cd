// Smooths outlines in the picture; one work group per tile that outlines touch. Where an outline runs along rows or
// columns of pixels and steps aside at its ends, the true outline is the line between the middles of the steps. This
// line divides each pixel that it crosses. The pixel mixes its own light with that of the neighbour across the line,
// by the areas of both parts (after Reshetnikov 2009).
#include "view.glsl"
#include "shaded.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 0) readonly buffer Shaded { uvec2 shaded[]; };
layout(std430, binding = 1) readonly buffer Outlines { uint outlines[]; };
#include "outline_tiles.glsl"
layout(rgba8, binding = 0) writeonly uniform image2D picture;

const int most_steps = 16;      // pixels along an outline that are searched for its end, each way
const float straight = 0.125;   // share of the neighbour's light where an outline has no end within reach
const float alone = 0.125;      // the same for each neighbour of a pixel that is a layer of its own

bool is_inside(ivec2 pixel) { return all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, size.xy)); }
uint bits_at(ivec2 pixel) { return is_inside(pixel) ? outlines[pixel.y * size.x + pixel.x] : 0u; }

// True if an outline lies between a pixel and the neighbour at `side`, one pixel along x or y.
bool parts(ivec2 pixel, ivec2 side) {
  const ivec2 low = pixel + min(side, ivec2(0));
  return (bits_at(low) & (side.x != 0 ? 1u : 2u)) != 0u;
}

// Follows the outline between a pixel and its neighbour at `side` along `way`. Returns the number of further pixels
// that it runs on for; `turn`: 1 if it then turns to the pixel's side, -1 if to the neighbour's, 0 if neither.
int follow(ivec2 pixel, ivec2 side, ivec2 way, out int turn) {
  turn = 0;
  for (int steps = 0; steps < most_steps; ++steps) {
    const ivec2 here = pixel + steps * way;
    const bool aside = parts(here, way), beyond = parts(here + side, way);
    if (aside || beyond || !parts(here + way, side)) {
      turn = int(aside) - int(beyond);
      return steps;
    }
  }
  return most_steps;
}

// Share of the neighbour's light in a pixel.
float share_beyond(ivec2 pixel, ivec2 side) {
  const ivec2 way = side.yx;
  int turn_before, turn_after;
  const int before = follow(pixel, side, -way, turn_before), after = follow(pixel, side, way, turn_after);
  if (turn_before == 0 && turn_after == 0) return straight;
  const float length = float(before + after + 1), at = (float(before) + 0.5) / length;
  const float height = at < 0.5 ? float(turn_before) * (0.5 - at) : float(turn_after) * (at - 0.5);
  return max(height, 0.0);
}

void main() {
  const uint across = uint(size.x + 15) / 16u, tile = tiles[gl_WorkGroupID.x];
  const ivec2 pixel = ivec2(16, 8) * ivec2(tile % across, tile / across) + ivec2(gl_LocalInvocationID.xy);
  if (any(greaterThanEqual(pixel, size.xy))) return;
  const int at = pixel.y * size.x + pixel.x;
  vec3 light = unpacked_light(shaded[at]);
  const ivec2 sides[4] = ivec2[](ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1));
  const uint own = outlines[at], left = bits_at(pixel - ivec2(1, 0)), below = bits_at(pixel - ivec2(0, 1));
  const bvec4 parted = bvec4((own & 1u) != 0u, (left & 1u) != 0u, (own & 2u) != 0u, (below & 2u) != 0u);
  if (!any(parted)) return;
  vec3 sum = vec3(0.0);
  float shares = 0.0;
  for (int k = 0; k < 4; ++k) {
    if (!parted[k]) continue;
    const ivec2 there = pixel + sides[k];
    const float share = all(parted) ? alone : share_beyond(pixel, sides[k]);
    sum += share * unpacked_light(shaded[there.y * size.x + there.x]);
    shares += share;
  }
  const float kept = max(1.0 - shares, 0.25);
  light = (kept * light + sum) / (kept + shares);
  imageStore(picture, pixel + ivec2(origin.xy), vec4(encode_srgb(light), 1.0));
}
