// Shades water over the room: Fresnel (Schlick), refraction, Beer-Lambert absorption. Writes sRGB.
#include "view.glsl"
#include "room.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 0) readonly buffer Nearness { float nearness[]; };
layout(std430, binding = 2) readonly buffer Thickness { float thickness[]; };
#ifdef FOAM
#include "foam.glsl"
layout(std430, binding = 1) buffer Normals { vec4 normals[]; };
layout(std430, binding = 3) buffer Cover { uint cover[]; };
#else
layout(std430, binding = 1) readonly buffer Normals { vec4 normals[]; };
#endif
layout(rgba8, binding = 0) writeonly uniform image2D picture;

const vec3 in_scatter = vec3(0.004, 0.050, 0.080);  // light scattered back by deep water
const float thin_m = 0.03;                          // thickness below which water reflects less, m

float water_length(vec2 xy) {
  const vec2 g = xy / thickness_rule.z - 0.5;
  const ivec2 last = size.zw - 1;
  const ivec2 low = clamp(ivec2(floor(g)), ivec2(0), last), high = min(low + 1, last);
  const vec2 f = clamp(g - vec2(low), 0.0, 1.0);
  const float a = mix(thickness[low.y * size.z + low.x], thickness[low.y * size.z + high.x], f.x);
  const float b = mix(thickness[high.y * size.z + low.x], thickness[high.y * size.z + high.x], f.x);
  return mix(a, b, f.y) * thickness_rule.y;
}

vec3 water(vec3 position, vec3 d, vec3 n, float length_m, float footprint_per_m, float distance_m) {
  const float facing = clamp(-dot(d, n), 0.0, 1.0);
  const float fresnel = reflected_share(facing) * smoothstep(0.0, thin_m, length_m);
  const vec3 inside = refract(d, n, into_water);
  float room = max(cross_tank(position, inside).leave, 0.0);
#ifdef OBSTACLES
  room = min(room, meet_obstacles(position, inside).at);
#endif
  const float way = min(length_m, room);
  const vec3 out_direction = normalize(mix(d, inside, clamp(length_m / max(room, 1e-3), 0.0, 1.0)));
  const vec3 behind = seen_from_inside(position + (way - 1e-3) * inside, out_direction, footprint_per_m, distance_m + way);
  const vec3 kept = exp(-absorption.rgb * way);
  const vec3 body = behind * kept + in_scatter * (1.0 - exp(-0.25 * way)) * (0.75 + 0.35 * max(dot(n, sun), 0.0));
  const vec3 mirrored = reflect(d, n);
  vec3 reflection = seen_from_inside(position, mirrored, footprint_per_m, distance_m);
  reflection += vec3(1.0, 0.93, 0.8) * (9.0 * pow(max(dot(mirrored, sun), 0.0), 600.0));
  return mix(body, reflection, fresnel);
}

// Opacity of a fluid pixel, to soften the steps of the outline. It rises with the number of fluid pixels among the 8
// neighbours: from 0.4 for a lone pixel, such as a distant droplet, to 1.
float outline_cover(ivec2 pixel) {
  int fluid = 0;
  for (int y = -1; y <= 1; ++y) {
    for (int x = -1; x <= 1; ++x) {
      const ivec2 near = clamp(pixel + ivec2(x, y), ivec2(0), size.xy - 1);
      fluid += int(nearness[near.y * size.x + near.x] > 0.0);
    }
  }
  return mix(0.4, 1.0, float(fluid - 1) / 8.0);
}

vec3 encode_srgb(vec3 c) {
  const vec3 x = clamp(c, 0.0, 1.0);
  return mix(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, 12.92 * x, lessThanEqual(x, vec3(0.0031308)));
}

#ifdef FOAM
// Light from white foam under sun and sky.
vec3 foam_light(vec3 n) { return vec3(0.42, 0.45, 0.48) + vec3(0.52, 0.50, 0.46) * max(dot(n, sun), 0.0); }

// Share of a pixel that foam covers; x: foam on the water or in front of it, y: foam below its surface. Sets the
// pixel's sums to 0 for the next picture.
vec2 foam_cover(int at) {
  const vec2 depths = vec2(cover[2 * at], cover[2 * at + 1]) / foam_units;
  cover[2 * at] = cover[2 * at + 1] = 0u;
  return 1.0 - exp(-depths);
}

uint scrambled(uint word) {
  word = (word ^ (word >> 16)) * 0x45d9f3bu;
  word = (word ^ (word >> 16)) * 0x45d9f3bu;
  return word ^ (word >> 16);
}

// A normal of foamy water for saliency, which reads the G-buffer: the smooth normal mixed with a random one by the
// share `covered`. The random normals are distributed like those over the visible disc of a sphere.
vec3 rough_normal(vec3 smooth_one, int at, float covered) {
  const uint first = scrambled(uint(at)), second = scrambled(first + 1u);
  const float squared = float(first >> 8) / 16777216.0, angle = 6.2831853 * float(second >> 8) / 16777216.0;
  const vec3 bubble = vec3(sqrt(squared) * vec2(cos(angle), sin(angle)), sqrt(1.0 - squared));
  const vec3 mixed = mix(smooth_one, bubble, covered);
  return length(mixed) > 0.1 ? normalize(mixed) : smooth_one;
}
#endif

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, size.xy))) return;
  const vec2 xy = vec2(pixel) + 0.5;
  const vec2 slope = slope_at(xy);
  const vec3 eye = eye_to_world[3].xyz;
  const vec3 ray = vec3(slope, -1.0);
  const vec3 d = normalize(mat3(eye_to_world) * ray);
  const float per_depth = length(ray);
  const float footprint_per_m = rays.z / per_depth;
  const Crossing crossing = cross_tank(eye, d);
  float frame_at;
  float cover = near_frame(crossing, eye, d, footprint_per_m, frame_at);
  const int at = pixel.y * size.x + pixel.x;
  bool is_water = nearness[at] > 0.0;
#ifdef OBSTACLES
  const float obstacle_at = meet_obstacles(eye, d).at;
  if (is_water && obstacle_at < per_depth / nearness[at]) is_water = false;
  if (obstacle_at < frame_at) cover = 0.0;
#endif
  const float water_cover = is_water ? outline_cover(pixel) : 0.0;
  vec3 light = vec3(0.0);
#ifdef FOAM
  const vec2 foam = foam_cover(at);
  vec3 foam_normal = vec3(0.0, 1.0, 0.0);
#endif
  if (water_cover < 1.0) light = seen(crossing, eye, d, footprint_per_m);
  if (is_water) {
    const float distance_m = per_depth / nearness[at];
    const vec3 n = normalize(mat3(eye_to_world) * normals[at].xyz);
    const vec3 position = clamp(eye + distance_m * d, vec3(1e-3), min(tank_high(), vec3(1e4)) - vec3(1e-3));
    vec3 shaded = water(position, d, n, water_length(xy), footprint_per_m, distance_m);
#ifdef FOAM
    shaded = mix(shaded, vec3(0.60, 0.80, 0.84), 0.8 * foam.y);
    foam_normal = n;
    if (foam.x > 0.0) normals[at].xyz = rough_normal(normals[at].xyz, at, foam.x);
#endif
    light = mix(light, shaded, water_cover);
    // Water nearer than the tank's frame hides it. The tolerance keeps the frame visible over water at the wall.
    if (distance_m < 0.999 * frame_at) cover = 0.0;
  }
#ifdef FOAM
  light = mix(light, foam_light(foam_normal), foam.x);
#endif
  imageStore(picture, pixel + ivec2(origin.xy), vec4(encode_srgb(mix(light, frame_colour, cover)), 1.0));
}
