// Draws a test scene for headsets, ray by ray: sky and ground with the horizon between them, a ramp of 256 greys, and
// discs.
layout(location = 0) out vec4 colour;

uniform vec3 eye;       // position, m
uniform mat3 turn;      // the eye's axes: right, up, back
uniform vec4 tangents;  // of the field of view: left, right, down, up
uniform float x;        // left edge of the picture, px
uniform vec2 size;      // of the picture, px
uniform vec4 ramp;      // edges of the ramp of greys: left, right, down, up, m
uniform float ramp_z;
uniform vec4 discs[3];  // centre x, y, z and radius, m; discs face +z
uniform vec3 paints[3];

// Sets `at` to the point (x, y) where the ray meets the plane at `z`; false if the plane lies behind the eye.
bool reach(vec3 ray, float z, out vec2 at) {
  const float way = (z - eye.z) / ray.z;
  at = eye.xy + way * ray.xy;
  return way > 0.0;
}

void main() {
  const vec2 share = (gl_FragCoord.xy - vec2(x, 0.0)) / size;
  const vec3 ray =
      turn * vec3(mix(tangents.x, tangents.y, share.x), mix(tangents.z, tangents.w, share.y), -1.0);
  colour = vec4(ray.y > 0.0 ? vec3(0.25, 0.25, 0.4) : vec3(0.2, 0.25, 0.2), 1.0);
  if (abs(ray.y) < 0.003 * length(ray.xz)) colour.rgb = vec3(1.0, 1.0, 0.0);
  vec2 at;
  if (reach(ray, ramp_z, at)) {
    const vec2 along = (at - ramp.xz) / (ramp.yw - ramp.xz);
    if (all(greaterThanEqual(along, vec2(0.0))) && all(lessThan(along, vec2(1.0))))
      colour.rgb = vec3(floor(256.0 * along.x) / 255.0);
  }
  for (int i = 2; i >= 0; --i) {  // discs[0], the nearest, is painted last
    if (reach(ray, discs[i].z, at) && distance(at, discs[i].xy) < discs[i].w) colour.rgb = paints[i];
  }
}
