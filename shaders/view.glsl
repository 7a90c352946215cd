// One eye. Eye space here: x right, y up, z = positive eye depth, m.
layout(std140, binding = 0) uniform ViewBlock {
  mat4 world_to_eye;  // OpenGL's: looking along -z
  mat4 eye_to_world;
  vec4 rays;            // slope of the ray through pixel coordinates xy: xy * rays.xz + rays.yw
  ivec4 size;           // width, height; width and height of the thickness grid
  vec4 origin;          // viewport's lower left corner; near plane; splatted radius / own radius
  vec4 narrow_range;    // sigma, delta, mu in particle radii; largest reach in px
  vec4 thickness_rule;  // units per m; m per unit, through water; pixels per grid cell; largest number of taps
  vec4 absorption;      // per m; 1: the tank has a lid
  vec4 tank;            // size from (0, 0, 0); 1: its walls cut the spheres
};

// The tank's high corner, far above without a lid.
vec3 tank_high() { return vec3(tank.x, absorption.w > 0.0 ? tank.y : 1e6, tank.z); }

vec2 slope_at(vec2 xy) { return xy * rays.xz + rays.yw; }

const float no_depth = uintBitsToFloat(0x7f800000u);
bool is_fluid(float depth) { return floatBitsToUint(depth) < 0x7f800000u; }
// The depth filter works on nearness, 1 / depth. It is linear over the picture on every plane, so that means of
// mirror images keep planes, however they are turned. 0: no water.
float nearness_of(float depth) { return is_fluid(depth) ? 1.0 / depth : 0.0; }

// Direction in the world for one unit of eye depth, never along a wall. `precise`: passes must agree.
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
