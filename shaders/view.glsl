// One eye. Eye space here: x right, y up, z = positive eye depth, m.
layout(std140, binding = 0) uniform ViewBlock {
  mat4 world_to_eye;  // OpenGL's: looking along -z
  mat4 eye_to_world;
  vec4 rays;            // slope of the ray through pixel coordinates xy: xy * rays.xz + rays.yw
  ivec4 size;           // width, height; width and height of the thickness grid
  vec4 origin;          // viewport's lower left corner; near plane; splatted radius / own radius
  vec4 narrow_range;    // sigma, delta, mu in particle radii; largest reach in px
  vec4 thickness_rule;  // units per m; m per unit, through water; pixels per grid cell; largest number of taps
  vec4 absorption;      // per m
  vec4 tank;            // size from (0, 0, 0)
};

vec2 slope_at(vec2 xy) { return xy * rays.xz + rays.yw; }

const float no_depth = uintBitsToFloat(0x7f800000u);
bool is_fluid(float depth) { return floatBitsToUint(depth) < 0x7f800000u; }
