// Ellipsoids in place of the spheres of sphere.glsl, with functions of the same names. The matrix S of an ellipsoid is
// the sum over its axes of (half axis)^2 (direction) (direction)^T; its points are x with x^T S^-1 x <= 1.
layout(std430, binding = 8) readonly buffer Shapes { uvec4 shapes[]; };  // RenderShape

struct Sphere {
  vec3 centre;   // eye space, z = positive depth
  float radius;  // of the sphere of equal volume, as the particle would be splatted
  bool cut;      // as in sphere.glsl, like the five fields that follow
  vec3 wall, inward;
  mat3 to_world;
  float near;
  uint nearest;
  vec3 diagonal;  // of S in eye space: the squares of the half extents
  vec2 mixed;     // S.xz and S.yz
  vec3 row_z;     // W maps the ellipsoid to the unit sphere and is lower triangular: its last row,
  vec3 row_xy;    // W.xx, W.yx and W.yy
  vec3 at;        // W centre
  float share;    // of its chords that count as thickness: an ellipsoid larger than its sphere holds no more water
};

Sphere sphere_of(uint i) {
  const vec4 particle = particles[i];
  const uvec4 words = shapes[i];
  const float scale = uintBitsToFloat(words.w);
  const vec2 a = unpackSnorm2x16(words.x), b = unpackSnorm2x16(words.y), c = unpackSnorm2x16(words.z);
  precise mat3 square =
      mat3(vec3(a.x, b.y, c.x) * scale, vec3(b.y, a.y, c.y) * scale, vec3(c.x, c.y, b.x) * scale);
  precise vec3 eye = world_to_eye[0].xyz * particle.x + world_to_eye[1].xyz * particle.y +
                     world_to_eye[2].xyz * particle.z + world_to_eye[3].xyz;
  const vec3 right = vec3(world_to_eye[0].x, world_to_eye[1].x, world_to_eye[2].x);
  const vec3 up = vec3(world_to_eye[0].y, world_to_eye[1].y, world_to_eye[2].y);
  const vec3 ahead = -vec3(world_to_eye[0].z, world_to_eye[1].z, world_to_eye[2].z);
  precise vec3 s_right = square * right, s_up = square * up, s_ahead = square * ahead;
  precise vec3 diagonal = vec3(dot(right, s_right), dot(up, s_up), dot(ahead, s_ahead));
  precise float xy = dot(right, s_up);
  precise vec2 mixed = vec2(dot(right, s_ahead), dot(up, s_ahead));
  // Cholesky factor L of S, and W = L^-1.
  const float least = 1e-6 * scale;
  precise float w_xx = inversesqrt(max(diagonal.x, least));
  precise float l_yx = xy * w_xx, l_zx = mixed.x * w_xx;
  precise float w_yy = inversesqrt(max(diagonal.y - l_yx * l_yx, least));
  precise float l_zy = (mixed.y - l_zx * l_yx) * w_yy;
  precise float w_zz = inversesqrt(max(diagonal.z - l_zx * l_zx - l_zy * l_zy, least));
  precise float w_yx = -l_yx * w_xx * w_yy;
  precise vec3 row_z = vec3(-(l_zx * w_xx + l_zy * w_yx) * w_zz, -l_zy * w_yy * w_zz, w_zz);
  precise vec3 row_xy = vec3(w_xx, w_yx, w_yy);
  precise vec3 centre = vec3(eye.xy, -eye.z);
  precise vec3 at = vec3(w_xx * centre.x, w_yx * centre.x + w_yy * centre.y,
                         row_z.x * centre.x + row_z.y * centre.y + row_z.z * centre.z);
  precise float radius = particle.w * origin.w;
  precise float share = min(radius * radius * radius * w_xx * w_yy * w_zz, 1.0);
  const vec3 reach = sqrt(vec3(square[0].x, square[1].y, square[2].z));
  const bvec3 low = lessThan(particle.xyz, reach);
  const bvec3 high = greaterThan(particle.xyz, tank_high() - reach);
  const vec3 wall = mix(mix(vec3(-1e6), tank.xyz, high), vec3(0), low);
  const bool cut = tank.w > 0.0 && any(greaterThanEqual(wall, vec3(0)));
  const vec3 inward = mix(vec3(1), vec3(-1), greaterThan(wall, vec3(0)));
  const uint nearest = floatBitsToUint(max(-0.99999 * eye.z - 1.0001 * sqrt(diagonal.z), origin.z));
  return Sphere(centre, radius, cut, wall - eye_to_world[3].xyz, inward, mat3(eye_to_world), origin.z, nearest,
                diagonal, mixed, row_z, row_xy, at, share);
}

vec3 half_extent(Sphere s) { return sqrt(s.diagonal); }
float narrow_extent(Sphere s) { return sqrt(min(s.diagonal.x, s.diagonal.y)); }

// W (slope, 1): the ray's direction where the ellipsoid is the unit sphere.
vec3 direction_of(Sphere s, vec2 slope) {
  precise vec3 direction = vec3(s.row_xy.x * slope.x, s.row_xy.y * slope.x + s.row_xy.z * slope.y,
                                s.row_z.x * slope.x + s.row_z.y * slope.y + s.row_z.z);
  return direction;
}

bool meets_whole(Sphere s, vec2 slope, bool subpixel, out float entry, out float leave) {
  precise vec3 way = direction_of(s, slope);
  precise float inverse = 1.0 / (way.x * way.x + way.y * way.y + way.z * way.z);
  precise float middle = (s.at.x * way.x + s.at.y * way.y + s.at.z * way.z) * inverse;
  precise vec3 off = s.at - middle * way;
  precise float square = 1.0 - (off.x * off.x + off.y * off.y + off.z * off.z);
  if (subpixel) square = 1.0;
  precise float reach = sqrt(max(square, 0.0) * inverse);
  precise float first = middle - reach;
  entry = max(first, s.near);
  leave = middle + reach;
  return square > 0.0 && leave > s.near;
}

// Slopes of the planes through the eye that touch the ellipsoid and contain the other axis.
vec2 tangent_slopes(float x, float z, float xx, float zz, float xz) {
  const float a = z * z - zz, b = x * z - xz, c = x * x - xx;
  const float root = sqrt(max(b * b - a * c, 0.0));
  return vec2(b - root, b + root) / a;
}
vec2 slopes_x(Sphere s) {
  return tangent_slopes(s.centre.x, s.centre.z, s.diagonal.x, s.diagonal.z, s.mixed.x);
}
vec2 slopes_y(Sphere s) {
  return tangent_slopes(s.centre.y, s.centre.z, s.diagonal.y, s.diagonal.z, s.mixed.y);
}

float whole_chord(Sphere s, vec2 slope) {
  precise vec3 way = direction_of(s, slope);
  precise float x = s.at.y * way.z - s.at.z * way.y;
  precise float y = s.at.z * way.x - s.at.x * way.z;
  precise float z = s.at.x * way.y - s.at.y * way.x;
  precise float inverse = 1.0 / (way.x * way.x + way.y * way.y + way.z * way.z);
  precise float square = 1.0 - (x * x + y * y + z * z) * inverse;
  precise float chord = s.share * 2.0 * sqrt(max(square, 0.0) * inverse * (slope.x * slope.x + slope.y * slope.y + 1.0));
  return chord;
}
