// Camera of one eye. Slopes are x right and y up per unit of eye depth; eye depth is positive in front of the eye, m.
layout(std140, binding = 0) uniform ViewBlock {
  mat4 world_to_eye;  // OpenGL's convention: the eye looks along -z
  mat4 eye_to_world;
  vec4 rays;            // slope of the ray through pixel coordinates xy: xy * rays.xz + rays.yw
  ivec4 size;           // xy: width and height, px; zw: those of the thickness grid, cells
  vec4 origin;          // xy: viewport's lower left corner, px; z: near plane, m; w: splatted / particle radius
  vec4 narrow_range;    // of the depth filter: xyz RenderOptions::filter_sigma_r, _delta_r, _mu_r; w largest reach, px
  vec4 thickness_rule;  // x: units per m of chord; y: m of water per unit; z: px per cell; w: most filter samples
  vec4 absorption;      // xyz: of red, green and blue, 1/m; w: 1 if the tank has a lid
  vec4 tank;            // xyz: inner size, m, from (0, 0, 0); w: 1 if the walls cut the spheres
};

// The tank's high corner, m; without a lid y is 1e6.
vec3 tank_high() { return vec3(tank.x, absorption.w > 0.0 ? tank.y : 1e6, tank.z); }

vec2 slope_at(vec2 xy) { return xy * rays.xz + rays.yw; }

const float no_depth = uintBitsToFloat(0x7f800000u);
bool is_fluid(float depth) { return floatBitsToUint(depth) < 0x7f800000u; }
// Nearness, 1 / depth, 1/m; 0 without water. The depth filter works on nearness because, on a plane in any
// orientation, it is linear over the picture: the mean of a sample and its mirror image preserves the plane.
float nearness_of(float depth) { return is_fluid(depth) ? 1.0 / depth : 0.0; }

// World direction of a ray, per unit of eye depth. No component is 0, so that divisions by it are safe. `precise`:
// all passes must compute the same bits.
vec3 world_ray(vec2 slope, mat3 to_world) {
  precise vec3 ray = slope.x * to_world[0] + slope.y * to_world[1] - to_world[2];
  return mix(ray, vec3(1e-9), lessThan(abs(ray), vec3(1e-9)));
}

// Eye depths between which the ray is inside the walls, above the floor and below a lid.
vec2 tank_range(vec2 slope) {
  const vec3 ray = world_ray(slope, mat3(eye_to_world));
  const vec3 eye = eye_to_world[3].xyz;
  const vec3 a = -eye / ray;
  const vec3 b = (tank_high() - eye) / ray;
  const vec3 near = min(a, b), far = max(a, b);
  return vec2(max(near.x, max(near.y, near.z)), min(far.x, min(far.y, far.z)));
}
