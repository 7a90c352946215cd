// Sums on the floor the sunlight that the water's surface refracts. One invocation per cell of the surface map takes
// the rays of four neighbouring cells. Their light is spread evenly over the piece of floor between the points where
// the rays land: its brightness is the area between the rays without water, divided by the area of this piece. Light is
// lost where the surface reflects it, where an obstacle above the surface blocks it, and beyond the edge of the floor.
// If two of the rays land more than torn_cells apart, the surface is broken there, and the light of those rays that
// enter water is lost too.
#include "light.glsl"
#include "floor_maps.glsl"
#include "caustic_units.glsl"
#ifdef OBSTACLES
#include "obstacles.glsl"
#endif
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 0) readonly buffer Surface { vec4 surface[]; };
layout(std430, binding = 1) buffer Light { uint light[]; };

const float torn_cells = 12.0;  // floor cells; rays that land farther apart entered different bodies of water

struct Landing {
  vec2 at;     // where the ray meets the floor, in floor cells
  float kept;  // share of the ray's light that no obstacle blocks and the surface does not reflect
};

vec4 surface_at(ivec2 cell) {
  const ivec2 inside = clamp(cell, ivec2(0), maps.cells.xy - 1);
  return surface[inside.y * maps.cells.x + inside.x];
}

// Slope of the surface, m/m, from the cells before and after. A neighbour counts only if it has water and its height
// differs by less than 4 particle radii.
float rise(vec4 middle, vec4 before, vec4 after) {
  const float limit = 4.0 * middle.y;
  const bool has_before = before.y > 0.0 && abs(before.x - middle.x) < limit;
  const bool has_after = after.y > 0.0 && abs(after.x - middle.x) < limit;
  const float sum = (has_after ? after.x - middle.x : 0.0) + (has_before ? middle.x - before.x : 0.0);
  return sum / (maps.surface_grid.z * max(float(has_before) + float(has_after), 1.0));
}

#ifdef OBSTACLES
// True if an obstacle blocks the sunlight on its way to the surface, which has the height height_m there.
bool is_kept_off(vec2 straight, float height_m) {
  const vec2 under = straight + leans * height_m;
  const vec3 low = vec3(under.x, height_m, under.y);
  const float far_m = maps.tank.x + maps.tank.y + maps.tank.z;
  const vec3 up = normalize(sun);
  return meet_obstacles(low + far_m * up, -up).at < far_m;
}
#endif

Landing landing_of(ivec2 cell) {
  const vec2 straight = place_of(cell);
  const vec4 middle = surface_at(cell);
  const float pool = pool_share(middle);
  vec2 at = straight;
  float kept = 1.0;
  if (pool > 0.0) {
    const vec2 slope = vec2(rise(middle, surface_at(cell - ivec2(1, 0)), surface_at(cell + ivec2(1, 0))),
                            rise(middle, surface_at(cell - ivec2(0, 1)), surface_at(cell + ivec2(0, 1))));
    // The map stores heights Y by the position where the ray would meet the floor: the surface is y = Y(xz - leans y),
    // with `leans`, the ray's horizontal shift per metre of height.
    vec3 n = normalize(vec3(-slope.x, 1.0 + dot(leans, slope), -slope.y));
    if (dot(n, sun) < 0.05) n = vec3(0.0, 1.0, 0.0);
    const vec3 d = refract(-sun, n, into_water);
    const vec2 bent = straight + (leans + d.xz / max(-d.y, 0.1)) * middle.x;
    at = mix(straight, bent, pool);
    kept = 1.0 - pool * reflected_share(dot(n, sun));
  }
#ifdef OBSTACLES
  if (is_kept_off(straight, middle.x)) kept = 0.0;
#endif
  return Landing(at / maps.floor_grid.x, kept);
}

// Adds `units` of light to a rectangle of the floor; `middle` and `size` are in floor cells, and no side is longer than
// a cell. Each cell gets the share of the light that falls on it. Rectangles that tile the floor light it evenly.
void lay(vec2 middle, vec2 size, float units) {
  const vec2 from = middle - 0.5 * size;
  const ivec2 low = ivec2(floor(from));
  if (any(lessThan(low, ivec2(-1))) || any(greaterThanEqual(low, maps.cells.zw))) return;
  const vec2 first = clamp((vec2(low) + 1.0 - from) / max(size, vec2(1e-3)), 0.0, 1.0);
  for (int corner = 0; corner < 4; ++corner) {
    const ivec2 side = ivec2(corner & 1, corner >> 1);
    const ivec2 cell = low + side;
    if (any(lessThan(cell, ivec2(0))) || any(greaterThanEqual(cell, maps.cells.zw))) continue;
    const vec2 w = mix(first, 1.0 - first, vec2(side));
    const uint share = uint(units * w.x * w.y + 0.5);
    if (share > 0u) atomicAdd(light[cell.y * maps.cells.z + cell.x], share);
  }
}

void main() {
  const ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(cell, maps.cells.xy - 1))) return;
  Landing corners[4];
  for (int k = 0; k < 4; ++k) corners[k] = landing_of(cell + ivec2(k & 1, k >> 1));
  vec2 sides = max(max(abs(corners[1].at - corners[0].at), abs(corners[3].at - corners[2].at)),
                   max(abs(corners[2].at - corners[0].at), abs(corners[3].at - corners[1].at)));
  const float edge = maps.surface_grid.z / maps.floor_grid.x;
  const bool torn = max(sides.x, sides.y) > torn_cells;
  if (torn) sides = vec2(edge);
  const int parts = int(ceil(max(max(sides.x, sides.y) - 0.01, 1.0)));
  const vec2 size = min(sides / float(parts), 1.0);
  const float units = caustic_units * edge * edge / float(parts * parts);
  for (int j = 0; j < parts; ++j) {
    for (int i = 0; i < parts; ++i) {
      const vec2 f = (vec2(i, j) + 0.5) / float(parts);
      // If the rays land too far apart, each part uses the ray of the nearest corner instead of a mean of four rays.
      const vec2 w = torn ? step(0.5, f) : f;
      const vec2 at = mix(mix(corners[0].at, corners[1].at, w.x), mix(corners[2].at, corners[3].at, w.x), w.y);
      const float kept =
          mix(mix(corners[0].kept, corners[1].kept, w.x), mix(corners[2].kept, corners[3].kept, w.x), w.y);
      const bool broken = torn && surface_at(cell + ivec2(w)).y > 0.0;
      if (!broken) lay(torn ? at + (f - w) * edge : at, size, units * kept);
    }
  }
}
