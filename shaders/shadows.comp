// Computes the share of sunlight that obstacles and flying water let through to the floor, and the length of the ray's
// path in the pool: one invocation per cell of the floor map. The ray to the cell is refracted by a flat surface at the
// height of the water where the ray enters it.
#include "light.glsl"
#include "floor_maps.glsl"
#ifdef OBSTACLES
#include "obstacles.glsl"
#endif
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 0) readonly buffer Surface { vec4 surface[]; };
layout(std430, binding = 1) writeonly buffer Shadow { vec2 shadow[]; };  // unblocked share; path in the pool, m

const float turned_aside_per_m = 4.0;  // attenuation of light by scattering in flying water, 1/m
const float sun_radius = 0.00465;      // angular radius, rad
const int rays = 8;                    // per cell; each joins another point of the cell with another point of the sun

vec4 surface_near(vec2 place) {
  const vec2 g = (place - maps.surface_grid.xy) / maps.surface_grid.z - 0.5;
  const ivec2 low = clamp(ivec2(floor(g)), ivec2(0), maps.cells.xy - 2);
  const vec2 f = clamp(g - vec2(low), 0.0, 1.0);
  const int at = low.y * maps.cells.x + low.x, next = at + maps.cells.x;
  return mix(mix(surface[at], surface[at + 1], f.x), mix(surface[next], surface[next + 1], f.x), f.y);
}

// Value of the surface map where the ray that reaches a point of the floor enters the water; found by iteration.
vec4 entry_of(vec2 place) {
  vec4 found = surface_near(place);
  for (int k = 0; k < 3; ++k) {
    const float height = found.x * pool_share(found);
    found = surface_near(place + (leans_in_water - leans) * height);
  }
  return found;
}

#ifdef OBSTACLES
// True if an obstacle blocks the ray from `low` along `up` within `length_m` m. The test ray points down from the far
// end, so that it enters an obstacle on the floor from outside.
bool meets(vec3 low, vec3 up, float length_m) {
  return meet_obstacles(low + length_m * up, -up).at < length_m;
}

// True if an obstacle may shade a point of the floor. The shadow of the obstacle's bounding ball lies within 1.6 of
// the ball's radii around the shadow of its centre, whatever part of the path is in water.
bool may_be_dark(vec2 place, float depth) {
  for (int k = 0; k < obstacle_count; ++k) {
    const vec4 centre = obstacles[3 * k];
    const float under = min(centre.y, depth);
    const vec2 middle = centre.xz - leans_in_water * under - leans * (centre.y - under);
    const float reach = 1.6 * (centre.w + length(obstacles[3 * k + 1].xyz)) + maps.floor_grid.x;
    if (distance(place, middle) < reach) return true;
  }
  return false;
}

float open_share(vec2 place, float depth) {
  if (!may_be_dark(place, depth)) return 1.0;
  const float far_m = maps.tank.x + maps.tank.y + maps.tank.z;
  const vec3 across = normalize(cross(sun, vec3(0.0, 0.0, 1.0))), along = cross(across, sun);
  int open = 0;
  for (int k = 0; k < rays; ++k) {
    // Points of Vogel's spiral over the sun's disc; over the cell the same points with swapped axes.
    const float turn = 2.3999632 * float(k), out_to = sqrt((float(k) + 0.5) / float(rays));
    const vec2 disc = out_to * vec2(cos(turn), sin(turn));
    const vec3 up = normalize(sun + sun_radius * (disc.x * across + disc.y * along));
    const vec2 from = place + 0.5 * maps.floor_grid.x * disc.yx;
    const vec2 lean = up.xz * into_water * inversesqrt(1.0 - into_water * into_water * (1.0 - up.y * up.y));
    const vec3 way = vec3(lean.x, 1.0, lean.y) * depth;
    const vec3 low = vec3(from.x, 0.0, from.y);
    const bool blocked = meets(low + way, up, far_m) || (depth > 0.0 && meets(low, normalize(way), length(way)));
    open += int(!blocked);
  }
  return float(open) / float(rays);
}
#endif

void main() {
  const ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(cell, maps.cells.zw))) return;
  const vec2 place = (vec2(cell) + 0.5) * maps.floor_grid.x;
  const vec4 entry = entry_of(place);
  const float pool = pool_share(entry);
  float open = exp(-turned_aside_per_m * (1.0 - pool) * entry.z);
#ifdef OBSTACLES
  open *= open_share(place, pool * entry.x);
#endif
  shadow[cell.y * maps.cells.z + cell.x] = vec2(open, pool * entry.z * sun.y * way_per_depth);
}
