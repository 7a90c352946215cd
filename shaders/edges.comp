// Smooths outlines and writes the picture in sRGB. Where an outline runs along rows or columns of pixels and steps
// aside at its ends, the true outline is the line between the middles of the steps: each pixel that it crosses takes
// the light of its neighbour beyond the outline, by the share that lies beyond (after Reshetnikov 2009).
#include "view.glsl"
#include "shaded.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 0) readonly buffer Shaded { uvec2 shaded[]; };
layout(std430, binding = 1) readonly buffer Outlines { uint outlines[]; };
#ifdef FOAM
layout(std430, binding = 2) buffer Normals { vec4 normals[]; };
layout(std430, binding = 3) buffer Cover { uint cover[]; };
#endif
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

vec3 encode_srgb(vec3 c) {
  const vec3 x = clamp(c, 0.0, 1.0);
  return mix(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, 12.92 * x, lessThanEqual(x, vec3(0.0031308)));
}

#ifdef FOAM
uint scrambled(uint word) {
  word = (word ^ (word >> 16)) * 0x45d9f3bu;
  word = (word ^ (word >> 16)) * 0x45d9f3bu;
  return word ^ (word >> 16);
}

// A normal of foamy water for saliency, which reads the G-buffer: the smooth normal mixed with a random one by the
// share `covered`. The random normals are distributed like those over the visible disc of a sphere.
vec3 rough_normal(vec3 smooth_one, int at, float covered) {
  const uint first = scrambled(uint(at)), second = scrambled(first + 1u);
  const float squared = float(first >> 8) / 16777216.0, angle = 6.2831853 * float(second >> 8) / 16777216.0;
  const vec3 bubble = vec3(sqrt(squared) * vec2(cos(angle), sin(angle)), sqrt(1.0 - squared));
  const vec3 mixed = mix(smooth_one, bubble, covered);
  return length(mixed) > 0.1 ? normalize(mixed) : smooth_one;
}

// Leaves the normals to saliency, and the foam's sums at 0 for the next picture.
void leave_foam(int at) {
  const float covered = uintBitsToFloat(cover[2 * at]);
  cover[2 * at] = cover[2 * at + 1] = 0u;
  if (covered > 0.0) normals[at].xyz = rough_normal(normals[at].xyz, at, covered);
}
#endif

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, size.xy))) return;
  const int at = pixel.y * size.x + pixel.x;
  vec3 light = unpacked_light(shaded[at]);
#ifdef FOAM
  leave_foam(at);
#endif
  const ivec2 sides[4] = ivec2[](ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1));
  const uint own = outlines[at], left = bits_at(pixel - ivec2(1, 0)), below = bits_at(pixel - ivec2(0, 1));
  const bvec4 parted = bvec4((own & 1u) != 0u, (left & 1u) != 0u, (own & 2u) != 0u, (below & 2u) != 0u);
  vec3 sum = vec3(0.0);
  float shares = 0.0;
  for (int k = any(parted) ? 0 : 4; k < 4; ++k) {
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
