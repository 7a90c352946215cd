// Spheres of the splat passes. `precise`: the depth pass and the front pass must compute the same bits.
#include "usable.glsl"
layout(std430, binding = 0) readonly buffer Particles { vec4 particles[]; };
uniform uint particle_count;

#ifdef ELLIPSOIDS
#include "ellipsoid.glsl"
#else
// A sphere with copies of the view's data that its samples need, so that a loop over pixels does not load them again.
struct Sphere {
  vec3 centre;  // eye space, z = positive depth
  float radius;
  bool cut;   // true if walls cut spheres and the sphere reaches through a wall, the floor or a lid
  vec3 wall;  // per axis, position of the wall that the sphere reaches, relative to the eye, m; distant if none
  vec3 inward;  // per axis, direction from that wall into the tank, 1 or -1
  mat3 to_world;
  float near;
  uint nearest;  // bits of a lower bound of the sphere's depth
};

Sphere sphere_of(uint i) {
  const vec4 particle = particles[i];
  precise vec3 eye = world_to_eye[0].xyz * particle.x + world_to_eye[1].xyz * particle.y +
                     world_to_eye[2].xyz * particle.z + world_to_eye[3].xyz;
  precise float radius = particle.w * origin.w;
  const bvec3 low = lessThan(particle.xyz, vec3(radius));
  const bvec3 high = greaterThan(particle.xyz, tank_high() - radius);
  const vec3 wall = mix(mix(vec3(-1e6), tank.xyz, high), vec3(0), low);
  const bool cut = tank.w > 0.0 && any(greaterThanEqual(wall, vec3(0)));
  const vec3 inward = mix(vec3(1), vec3(-1), greaterThan(wall, vec3(0)));
  const uint nearest = floatBitsToUint(max(-0.99999 * eye.z - radius, origin.z));
  return Sphere(vec3(eye.xy, -eye.z), radius, cut, wall - eye_to_world[3].xyz, inward, mat3(eye_to_world), origin.z,
                nearest);
}

// Half the sphere's size along the x, y and z axes of eye space, m.
vec3 half_extent(Sphere s) { return vec3(s.radius); }
// Half the smallest size across the line of sight, m.
float narrow_extent(Sphere s) { return s.radius; }

// Depths at which a ray enters and leaves the whole sphere; false if it misses. The ray is assumed to pass through
// the centre of a subpixel sphere.
bool meets_whole(Sphere s, vec2 slope, bool subpixel, out float entry, out float leave) {
  precise float inverse = 1.0 / (slope.x * slope.x + slope.y * slope.y + 1.0);
  precise float middle = (s.centre.x * slope.x + s.centre.y * slope.y + s.centre.z) * inverse;
  precise float off_x = s.centre.x - middle * slope.x;
  precise float off_y = s.centre.y - middle * slope.y;
  precise float off_z = s.centre.z - middle;
  precise float square = s.radius * s.radius - (off_x * off_x + off_y * off_y + off_z * off_z);
  if (subpixel) square = s.radius * s.radius;
  precise float reach = sqrt(max(square, 0.0) * inverse);
  precise float first = middle - reach;
  entry = max(first, s.near);
  leave = middle + reach;
  return square > 0.0 && leave > s.near;
}

vec2 tangent_slopes(float x, float z, float radius) {
  const float root = radius * sqrt(x * x + z * z - radius * radius);
  return vec2(x * z - root, x * z + root) / (z * z - radius * radius);
}
// Bounds of the slopes, along one axis, of a sphere that does not cross the near plane.
vec2 slopes_x(Sphere s) { return tangent_slopes(s.centre.x, s.centre.z, s.radius); }
vec2 slopes_y(Sphere s) { return tangent_slopes(s.centre.y, s.centre.z, s.radius); }

// Length of the ray inside the whole sphere, m.
float whole_chord(Sphere s, vec2 slope) {
  // Squared distance of the centre from the ray, by the cross product.
  precise float x = s.centre.y - s.centre.z * slope.y;
  precise float y = s.centre.z * slope.x - s.centre.x;
  precise float z = s.centre.x * slope.y - s.centre.y * slope.x;
  precise float off = (x * x + y * y + z * z) / (slope.x * slope.x + slope.y * slope.y + 1.0);
  precise float chord = 2.0 * sqrt(max(s.radius * s.radius - off, 0.0));
  return chord;
}
#endif

bool beyond_walls(vec4 particle) {
  const vec3 at = particle.xyz;
  const float radius = particle.w * origin.w;
  return tank.w > 0.0 && (any(lessThan(at, vec3(-radius))) || any(greaterThan(at, tank_high() + radius)));
}

bool crosses_near(Sphere s) { return s.centre.z - half_extent(s).z < origin.z; }

// Radius in cells of a grid, at the centre's depth. Below sqrt(1/2) a disc may miss every cell centre.
float radius_in_cells(Sphere s, vec4 grid) {
  precise float cells = narrow_extent(s) / (s.centre.z * max(grid.x, grid.z));
  return cells;
}
bool is_subpixel(Sphere s, vec4 grid) { return !crosses_near(s) && radius_in_cells(s, grid) < 0.7072; }

// Clips the ray's section in the sphere to the inside of the walls; false if nothing is left.
bool between_walls(Sphere s, vec2 slope, inout float entry, inout float leave) {
  precise vec3 ray = world_ray(slope, s.to_world);
  precise vec3 at = s.wall / ray;
  const bvec3 enters = greaterThan(ray * s.inward, vec3(0));
  const vec3 in_at = mix(vec3(-1e9), at, enters), out_at = mix(at, vec3(1e9), enters);
  entry = max(entry, max(in_at.x, max(in_at.y, in_at.z)));
  leave = min(leave, min(out_at.x, min(out_at.y, out_at.z)));
  return leave > entry;
}

// Bounds of the slopes, along one axis, of the visible part of a sphere: the part beyond the near plane.
vec2 clipped_slopes(float x, float z, float reach_x, float reach_z) {
  const float low = x - reach_x, high = x + reach_x;
  return vec2(low / (low < 0 ? origin.z : z + reach_z), high / (high > 0 ? origin.z : z + reach_z));
}

// Cells whose centres the sphere may cover: lower corner, upper corner (exclusive). Empty: upper <= lower.
ivec4 footprint(Sphere s, vec4 grid, ivec2 cells) {
  if (s.centre.z + half_extent(s).z <= origin.z) return ivec4(0);
  const vec2 limit = vec2(cells);
  if (is_subpixel(s, grid)) {
    const vec2 cell = floor((s.centre.xy / s.centre.z - grid.yw) / grid.xz);
    if (any(lessThan(cell, vec2(0))) || any(greaterThanEqual(cell, limit))) return ivec4(0);
    return ivec4(cell, cell + 1.0);
  }
  const bool crossing = crosses_near(s);
  const vec3 extent = half_extent(s);
  const vec2 x = crossing ? clipped_slopes(s.centre.x, s.centre.z, extent.x, extent.z) : slopes_x(s);
  const vec2 y = crossing ? clipped_slopes(s.centre.y, s.centre.z, extent.y, extent.z) : slopes_y(s);
  // The tolerance of 0.01 cells covers rounding; meets_whole() decides for each cell.
  const vec2 low = ceil((vec2(x.x, y.x) - grid.yw) / grid.xz - 0.51);
  const vec2 high = floor((vec2(x.y, y.y) - grid.yw) / grid.xz - 0.49) + 1.0;
  return ivec4(clamp(low, vec2(0), limit), clamp(high, vec2(0), limit));
}

vec4 thickness_rays() { return vec4(rays.x * thickness_rule.z, rays.y, rays.z * thickness_rule.z, rays.w); }

vec2 cell_slope(ivec2 cell, vec4 grid) {
  precise vec2 slope = (vec2(cell) + 0.5) * grid.xz + grid.yw;
  return slope;
}

// Length of the ray inside the whole sphere, in thickness units; for a subpixel sphere, its volume / area of the cell.
// `precise`: splat.comp and splat_wide.comp must compute the same bits.
uint chord_units(Sphere s, vec2 slope, bool subpixel, vec4 grid, float units_per_m) {
  precise float chord;
  if (subpixel) {
    const vec2 cell = s.centre.z * grid.xz;
    chord = 4.18879 * s.radius * s.radius * s.radius / (cell.x * cell.y);
  } else if (crosses_near(s)) {
    float entry, leave;
    if (!meets_whole(s, slope, false, entry, leave)) return 0u;
    chord = (leave - entry) * sqrt(dot(slope, slope) + 1.0);
  } else {
    chord = whole_chord(s, slope);
  }
  return uint(min(chord * units_per_m + 0.5, 4294967040.0));
}
