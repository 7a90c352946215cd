// Rigid obstacles in the tank and pipes, and the first intersection of a ray with them. ONLY_PIPES: there are no other
// obstacles.
layout(std430, binding = 4) readonly buffer Obstacles {
  vec4 obstacles[];  // three per obstacle: (centre, radius), (half sides, kind), unit quaternion
};
uniform int obstacle_count;

const float mesh_kind = 1.0, pipe_kind = 2.0;  // other kinds are 0
const vec3 obstacle_colour = vec3(0.55, 0.20, 0.07), pipe_colour = vec3(0.34, 0.36, 0.38);
const float never = 1e30;
#ifdef MESHES
#include "obstacle_meshes.glsl"
#endif

struct Meeting {
  float at;  // distance along the ray; `never`: no intersection
  vec3 normal;
  float kind;
};

vec3 turned(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }

void nearer(inout Meeting m, float at, vec3 normal) {
  if (at > 0.0 && at < m.at) m = Meeting(at, normal, m.kind);
}

// Point where a ray from outside enters a ball with the centre (0, y, 0).
void meet_ball(inout Meeting m, vec3 o, vec3 d, float y, float radius) {
  const vec3 from = o - vec3(0.0, y, 0.0);
  const float b = dot(from, d), c = dot(from, from) - radius * radius;
  if (b * b < c) return;
  const float at = -b - sqrt(b * b - c);
  nearer(m, at, (from + at * d) / radius);
}

// Point where a ray from outside enters a cylinder around the y axis through its side.
void meet_side(inout Meeting m, vec3 o, vec3 d, float half_length, float radius) {
  const float a = dot(d.xz, d.xz), b = dot(o.xz, d.xz), c = dot(o.xz, o.xz) - radius * radius;
  if (a < 1e-12 || b * b < a * c) return;
  const float at = (-b - sqrt(b * b - a * c)) / a;
  const vec3 p = o + at * d;
  if (abs(p.y) <= half_length) nearer(m, at, vec3(p.x, 0.0, p.z) / radius);
}

// Point where a ray from outside enters the flat end of that cylinder at the height y, which faces +y if y > 0.
void meet_end(inout Meeting m, vec3 o, vec3 d, float y, float radius) {
  if (d.y * y >= 0.0) return;
  const float at = (y - o.y) / d.y;
  const vec2 p = o.xz + at * d.xz;
  if (dot(p, p) <= radius * radius) nearer(m, at, vec3(0.0, sign(y), 0.0));
}

void meet_box(inout Meeting m, vec3 o, vec3 d, vec3 half_sides) {
  const vec3 safe = mix(d, vec3(1e-9), lessThan(abs(d), vec3(1e-9)));
  const vec3 a = (-half_sides - o) / safe, b = (half_sides - o) / safe;
  const vec3 near = min(a, b), far = max(a, b);
  const float enter = max(near.x, max(near.y, near.z));
  if (enter > min(far.x, min(far.y, far.z))) return;
  nearer(m, enter, -sign(safe) * vec3(equal(near, vec3(enter))));
}

Meeting meet_obstacles(vec3 o, vec3 d) {
  Meeting m = Meeting(never, vec3(0.0), 0.0);
  for (int k = 0; k < obstacle_count; ++k) {
    const vec4 centre = obstacles[3 * k], half_sides = obstacles[3 * k + 1];
    if (half_sides.w == pipe_kind) {
      Meeting pipe = Meeting(m.at, m.normal, pipe_kind);
      meet_side(pipe, o - centre.xyz, d, half_sides.y, centre.w);
      meet_end(pipe, o - centre.xyz, d, -half_sides.y, centre.w);
      if (pipe.at < m.at) m = pipe;
      continue;
    }
#ifndef ONLY_PIPES
    const vec4 turn = obstacles[3 * k + 2];
    const vec4 back = vec4(-turn.xyz, turn.w);
    const vec3 from = turned(back, o - centre.xyz), along = turned(back, d);
    Meeting here = Meeting(m.at, vec3(0.0), half_sides.w);
#ifdef MESHES
    if (half_sides.w == mesh_kind) {
      const MeshGrid grid = mesh_grid(k);
      const float at = meet_mesh(grid, from, along);
      if (at > 0.0 && at < m.at) nearer(here, at, mesh_normal(grid, from + at * along));
    } else
#endif
    if (centre.w > 0.0) {
      meet_ball(here, from, along, half_sides.y, centre.w);
      meet_ball(here, from, along, -half_sides.y, centre.w);
      meet_side(here, from, along, half_sides.y, centre.w);
    } else {
      meet_box(here, from, along, half_sides.xyz);
    }
    if (here.at < m.at) m = Meeting(here.at, turned(turn, here.normal), here.kind);
#endif
  }
  return m;
}

vec3 obstacle_light(Meeting met) {
  const vec3 colour = met.kind == pipe_kind ? pipe_colour : obstacle_colour;
  return colour * (0.35 + 0.25 * max(met.normal.y, 0.0) + 0.8 * max(dot(met.normal, sun), 0.0));
}
