// The tank with its tiled floor, glass, frame and level marks, and what is seen through it. Colours are linear light.
#include "light.glsl"
#include "surroundings.glsl"
const float frame_m = 0.06;

#ifdef OBSTACLES
#include "obstacles.glsl"
#endif
#ifdef LIT_FLOOR
#include "lit_floor.glsl"
#endif

// Checker of 1 m tiles, averaged over a footprint of `width` m (box filter, exact).
float checker(vec2 p, vec2 width) {
  const vec2 w = max(width, vec2(1e-3));
  const vec2 i = 2.0 * (abs(fract((p - 0.5 * w) * 0.5) - 0.5) - abs(fract((p + 0.5 * w) * 0.5) - 0.5)) / w;
  return 0.5 - 0.5 * i.x * i.y;
}

const vec3 dark_tile = vec3(0.50, 0.53, 0.54), light_tile = vec3(0.80, 0.80, 0.77);
const vec3 mean_floor = 0.5 * (dark_tile + light_tile);

vec3 tiles(vec3 p, vec3 d, float width) {
  const vec2 wide = on_floor(d, width), joints = strips(p.xz, 0.012, 1.0, wide);
  const float joint = joints.x + joints.y - joints.x * joints.y;
  return mix(mix(dark_tile, light_tile, checker(p.xz, wide)), vec3(0.30, 0.31, 0.32), joint);
}

// Distance of a point on a face of the tank to the nearest edge of that face, m. `axis`: 0, 1, 2 = x, y, z, the axis
// across the face.
float edge_distance(vec3 p, int axis) {
  const vec3 to_side = min(p, tank.xyz - p);
  if (axis == 1) return min(to_side.x, to_side.z);
  const float along = axis == 0 ? to_side.z : to_side.x;
  return min(along, min(p.y, abs(tank.y - p.y)));
}

struct Crossing {
  float enter, leave;
  int enter_axis, leave_axis;
};

Crossing cross_tank(vec3 o, vec3 d) {
  const vec3 safe = mix(d, vec3(1e-9), lessThan(abs(d), vec3(1e-9)));
  const vec3 a = -o / safe, b = (tank.xyz - o) / safe;
  const vec3 near = min(a, b), far = max(a, b);
  Crossing c;
  c.enter = max(near.x, max(near.y, near.z));
  c.leave = min(far.x, min(far.y, far.z));
  c.enter_axis = c.enter == near.x ? 0 : (c.enter == near.y ? 1 : 2);
  c.leave_axis = c.leave == far.x ? 0 : (c.leave == far.y ? 1 : 2);
  return c;
}

const vec3 frame_colour = vec3(0.10, 0.11, 0.12);

// Share of a footprint of `width` m, around point p of a face of the tank, that the frame along the face's edges
// covers.
float frame_cover(vec3 p, int axis, float width) { return strip(edge_distance(p, axis), frame_m, width); }

// Share of the pixel that the frame on the tank's near side covers. `at`: distance to that side along the ray, m; 0
// if the eye is inside the tank or the ray misses it.
float near_frame(Crossing c, vec3 o, vec3 d, float footprint_per_m, out float at) {
  at = 0.0;
  if (c.leave <= max(c.enter, 0.0) || c.enter <= 0.0) return 0.0;
  at = c.enter;
  return frame_cover(o + c.enter * d, c.enter_axis, footprint_per_m * c.enter);
}

// Light that arrives along the ray d at point o, without the tank's frame on the side towards o. `framed`: opacity of
// frame and level marks on the far side, 0 to 1; `travelled`: way of the ray before o, m.
vec3 seen(vec3 o, vec3 d, float footprint_per_m, float travelled, float framed) {
#ifdef OBSTACLES
  const Meeting met = meet_obstacles(o, d);
  if (met.at < never) return obstacle_light(met);
#endif
  const Crossing c = cross_tank(o, d);
  // The ray passes the tank, or begins in it or at most 2 mm beyond a wall.
  const bool through = c.enter > 0.0 ? c.leave > c.enter : c.leave > -2e-3;
  const float way = through ? max(c.leave, 0.0) : 0.0, width = footprint_per_m * (travelled + way);
  const vec3 p = o + way * d;
  const float frame = through ? framed * frame_cover(p, c.leave_axis, width) : 0.0;
  if (through && c.leave_axis == 1 && d.y < 0.0) {
    vec3 below = tiles(p, d, width);
#ifdef LIT_FLOOR
    below *= floor_light(p, d, width);
#endif
    return mix(below, frame_colour, frame);
  }
  const vec3 beyond = surroundings(p, d, footprint_per_m, travelled + way);
  const bool above = c.leave_axis == 1;
  if (!through || (above && absorption.w == 0.0)) return mix(beyond, frame_colour, frame);
  const float mark = above ? 0.0 : framed * strips(p.y, 0.012, 1.0, width) * 0.35;
  const vec3 glass = mix(beyond * vec3(0.86, 0.93, 0.91) + vec3(0.012, 0.02, 0.02), vec3(0.9), mark);
  return mix(glass, frame_colour, frame);
}
