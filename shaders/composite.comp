// Shades water over the room: Fresnel (Schlick), refraction, Beer-Lambert absorption. Writes sRGB. Also leaves linear
// light and the nearness of what each pixel shows, from which edges.comp smooths outlines. DRY: for the tiles without
// water.
#include "view.glsl"
#include "room.glsl"
#include "shaded.glsl"
#include "wet_tiles.glsl"
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
layout(std430, binding = 6) writeonly buffer Shaded { uvec2 shaded[]; };
layout(std430, binding = 7) writeonly buffer Shown { float shown[]; };

const vec3 in_scatter = vec3(0.004, 0.050, 0.080);  // light scattered back by deep water
const float no_way_out = 1.0 - into_water * into_water;  // squared cosine at a wall below which light stays in water
const float back_spread = 0.15;  // angle by which the unknown back of water away from the walls spreads light, rad
const float most_steep = 3.0;   // smallest jump of depth that is no slanted surface, two splatted radii
const float most_bend = 0.35;                         // of a normal within a pixel, as a difference of unit vectors
const float thin_m = 0.01;                          // thickness below which water reflects less, m
const float least_share = 0.08;  // reflected share from which mirrored rays look for water in the picture
const int most_steps = 5;        // of such a ray
const float least_turn = 0.15;   // cosine at the surface of a mirrored ray that hardly turns
const float first_step_r = 3.0, step_growth = 2.0;

float water_length(vec2 xy) {
  const vec2 g = xy / thickness_rule.z - 0.5;
  const ivec2 last = size.zw - 1;
  const ivec2 low = clamp(ivec2(floor(g)), ivec2(0), last), high = min(low + 1, last);
  const vec2 f = clamp(g - vec2(low), 0.0, 1.0);
  const float a = mix(thickness[low.y * size.z + low.x], thickness[low.y * size.z + high.x], f.x);
  const float b = mix(thickness[high.y * size.z + low.x], thickness[high.y * size.z + high.x], f.x);
  return mix(a, b, f.y) * thickness_rule.y;
}

// Projects a vector of eye space: x and y of the result are pixel coordinates times depth, z is the depth.
vec3 in_pixels(vec3 v) { return vec3((v.xy + v.z * rays.yw) / rays.xz, -v.z); }

// Water in the picture that a mirrored ray meets: x: how much of the ray it takes, 0 to 1; y: its length along the
// pixel's ray, m. The ray is followed in steps that grow with the way; it meets water where a step ends not far behind
// the water that the picture shows there.
vec2 water_ahead(vec3 position, vec3 mirrored, float radius) {
  const vec3 from = in_pixels((world_to_eye * vec4(position, 1.0)).xyz);
  const vec3 along = in_pixels(mat3(world_to_eye) * mirrored);
  float way = first_step_r * radius, before = 0.0;
  bool in_air = false;
  vec2 xy = vec2(-1.0);
  int k = 0;
  for (; k < most_steps; ++k, before = way, way *= step_growth) {
    const vec3 at = from + way * along;
    xy = at.xy / at.z;
    if (at.z < origin.z || any(lessThan(xy, vec2(0.0))) || any(greaterThanEqual(xy, vec2(size.xy)))) {
      k = most_steps;
      break;
    }
    float there = nearness[int(xy.y) * size.x + int(xy.x)];
    float behind = at.z - (there > 0.0 ? 1.0 / there : 1e9);
    if (behind < 0.0) in_air = true;
    if (in_air && behind >= 0.0 && behind <= way - before + 2.0 * radius) break;
  }
  if (k == most_steps) return vec2(0.0);
  const vec2 to_border = min(xy, vec2(size.xy) - xy) / vec2(size.xy);
  const float inside = smoothstep(0.0, 0.1, min(to_border.x, to_border.y));
  return vec2(inside * (1.0 - smoothstep(0.7, 1.0, float(k) / float(most_steps))), water_length(xy));
}

// Light that the surface with the normal n mirrors into the eye's ray d. A ray that is mirrored downwards meets water
// again: its light is that of the direction mirrored once more, less what the water takes, which is more where it falls
// more steeply. Upright water at the near glass mirrors the ground instead. A falling ray that hardly turns, and falls
// on, goes into the water below a rim: `share`, of the mirrored light, decreases to 0.
vec3 mirrored_light(vec3 position, vec3 d, vec3 n, bool at_glass, float radius, float width_per_m, inout float share) {
  const vec3 mirrored = reflect(d, n);
  const float turns = smoothstep(least_turn, 2.0 * least_turn, -dot(d, n));
  const float down = at_glass && abs(n.y) < 0.1 ? 0.0 : smoothstep(0.0, 0.2, -mirrored.y);
  share *= 1.0 - down * (1.0 - turns) * smoothstep(0.0, 0.1, -d.y);
#ifdef OBSTACLES
  const Meeting met = meet_obstacles(position, mirrored);
  if (met.at < never) return obstacle_light(met);
#endif
  const vec3 up = down > 0.0 ? vec3(mirrored.x, -mirrored.y, mirrored.z) : mirrored;
  vec3 light = surroundings(position, up, width_per_m, 0.0);
  light += vec3(1.0, 0.93, 0.8) * (9.0 * pow(max(dot(mirrored, sun), 0.0), 600.0));
  if (share > least_share && turns > 0.0) {
    vec2 ahead = water_ahead(position, mirrored, radius);
    ahead.x *= turns * smoothstep(least_share, 2.0 * least_share, share);
    light = mix(light, light * exp(-absorption.rgb * ahead.y) + in_scatter * (1.0 - exp(-0.25 * ahead.y)), ahead.x);
  }
  return (1.0 - 0.5 * down * turns) * light;
}

// A ray that goes on behind the surface, and what becomes of its light on the way to the eye: light * kept + added.
struct Behind {
  vec3 from, along;
  float footprint_per_m, travelled, framed;  // as in seen()
  vec3 kept, added;
};

// The way of the eye's ray d through the water. `bend`: how far the normal n turns within the pixel; the footprint
// widens by the angle by which refraction then spreads the rays. Where the normal turns within one particle, light is
// spread as by an unknown back: the surface is not known that finely, and would bend lines of the ground to loops.
// `length_m`: of the water along d; `wall_m`: way along d to the tank's wall or an obstacle.
Behind refracted(vec3 position, vec3 d, vec3 n, bool at_glass, float bend, float length_m, float wall_m, float radius,
                 float footprint_per_m, float distance_m) {
  const vec3 inside = refract(d, n, into_water);
  const Crossing crossing = cross_tank(position, inside);
  float room = max(crossing.leave, 0.0);
#if defined(OBSTACLES) && !defined(ONLY_PIPES)
  room = min(room, meet_obstacles(position, inside).at);
#endif
  // Water that fills the way to the wall is a pool. Its length is a sum of chords, which is not exact.
  const float to_wall = clamp((1.1 * length_m + 1.5 * radius) / max(wall_m, 1e-3), 0.0, 1.0);
  const float way = mix(min(length_m, room), room, smoothstep(0.85, 1.0, to_wall));
  // Light leaves a pool through the tank's side or floor along `inside`, a sheet along d, and a drop turned once more.
  const float as_drop = (1.0 - smoothstep(1.0, 2.5, 0.5 * length_m / radius)) * (1.0 - to_wall);
  Behind behind;
  behind.from = position + (way - 1e-3) * inside;
  behind.along = normalize(mix(d, inside, to_wall + 2.0 * as_drop));
  // A side wall that light meets too slantwise to leave the water mirrors it to the floor. That needs water down to the
  // floor: a pool behind the near glass or below a level surface, or a floor that is no further than the ray has come.
  const int wall = crossing.leave_axis;
  const float slantwise = 1.0 - smoothstep(no_way_out - 0.04, no_way_out + 0.06, inside[wall] * inside[wall]);
  const float to_floor = behind.from.y / max(-inside.y, 0.05);
  const float water_below = at_glass ? 1.0 : smoothstep(0.3, 0.8, max(n.y, way / max(to_floor, 1e-3)));
  float mirrors = slantwise * water_below * smoothstep(0.9, 1.0, to_wall) * smoothstep(2.0, 4.0, way / radius);
  if (wall == 1 || room < crossing.leave) mirrors = 0.0;
  vec3 along = inside;
  along[wall] = -along[wall];
  // One ray is followed: mirrored from a share of one half on, through the wall below. Towards that share its light
  // fades into the floor's mean colour, so that the picture has no step.
  const float followed = abs(2.0 * mirrors - 1.0), through = way + min(2.0 * mirrors, 1.0) * min(to_floor, way);
  const vec3 kept = exp(-absorption.rgb * through);
  const vec3 instead = (1.0 - followed) * mean_floor * exp(-absorption.rgb * (through + position.y));
  if (mirrors > 0.5) behind.along = along;
  behind.framed = smoothstep(0.5, 0.9, to_wall);
  const float unknown = smoothstep(0.2, 0.6, bend * radius / (footprint_per_m * distance_m));
  behind.footprint_per_m = footprint_per_m + (1.0 - into_water) * bend * (1.0 + 2.0 * as_drop) +
                           back_spread * max(1.0 - behind.framed, unknown);
  behind.travelled = footprint_per_m / behind.footprint_per_m * distance_m + way;
  behind.kept = followed * kept;
  behind.added = in_scatter * (1.0 - exp(-0.25 * through)) * (0.75 + 0.35 * max(dot(n, sun), 0.0)) + instead;
  return behind;
}

// Mean of two steps of nearness, of those that count.
float mean_step(vec2 steps, vec2 counts) { return dot(steps, counts) / max(counts.x + counts.y, 1.0); }

// The normal of a pixel for shading, in eye space. It follows from the mean differences in nearness to the neighbours.
// Beside a jump of depth it is the mean normal of the neighbours on the same layer. Water that is seen at a slant keeps
// the steeper normal of the differences there, because each particle's own normal faces the eye too much. At the
// picture's border the depth filter sees one side only, so the normal is that of a pixel further inside. A normal that
// faces away from the eye is replaced by the nearest that does not. `bend`: how far the normal turns from this pixel to
// the next.
vec3 shading_normal(ivec2 pixel, int at, vec3 ray, out float bend) {
  const float centre = nearness[at], radius = normals[at].w * origin.w, reach = 2.0 * radius * centre * centre;
  const ivec2 low = max(pixel - 1, ivec2(0)), high = min(pixel + 1, size.xy - 1);
  const int row = pixel.y * size.x;
  const ivec4 there = ivec4(row + low.x, row + high.x, low.y * size.x + pixel.x, high.y * size.x + pixel.x);
  const vec4 beside = vec4(nearness[there.x], nearness[there.y], nearness[there.z], nearness[there.w]);
  const vec4 steps = vec4(centre - beside.x, beside.y - centre, centre - beside.z, beside.w - centre);
  const vec4 counts = vec4(lessThan(abs(steps), vec4(most_steep * reach)));
  const vec2 by_slope = vec2(mean_step(steps.xy, counts.xy), mean_step(steps.zw, counts.zw)) / rays.xz;
  const vec3 slanted = normalize(vec3(-by_slope, centre - dot(by_slope, ray.xy)));
  vec3 n = normals[at].xyz;
  if (all(lessThan(abs(steps), vec4(reach)))) {
    const int apart = int(clamp(0.25 * radius * centre / rays.x, 1.0, 8.0));
    const ivec2 aside = min(pixel + apart, size.xy - 1);
    bend = min(0.7 / float(apart) * length(normals[aside.y * size.x + aside.x].xyz - n), most_bend);
    n = slanted;
  } else {
    bend = most_bend;
    n *= 0.25;  // less than the neighbours: at a jump the pixel's own normal is the least certain
    for (int k = 0; k < 4; ++k)
      if (beside[k] > 0.0 && abs(steps[k]) < reach) n += normals[there[k]].xyz;
    n = normalize(n);
    if (dot(slanted, ray) > dot(n, ray)) n = slanted;
  }
  const ivec2 border = ivec2(clamp(0.5 * radius * centre / rays.x, 1.0, 24.0));
  const ivec2 inner = clamp(pixel, min(border, size.xy / 2), max(size.xy - 1 - border, size.xy / 2));
  if (inner != pixel) {
    const int inside = inner.y * size.x + inner.x;
    if (nearness[inside] > 0.0 && abs(nearness[inside] - centre) < 2.0 * reach) {
      n = normals[inside].xyz;
      bend = 0.0;
    }
  }
  const vec3 away = ray / length(ray);
  return normalize(n - max(dot(n, away) + 0.03, 0.0) * away);
}

// The normal of water that lies against the near side of the tank, in world space. The depth filter rounds off the
// edge between this water and the water's surface, so at the glass the glass's normal is taken. From one particle
// radius behind the glass on, the water's own normal n is taken. `bend`: as in shading_normal(); none at the glass.
vec3 flat_at_glass(vec3 n, Crossing c, vec3 d, float distance_m, float radius, inout float bend) {
  if (tank.w == 0.0 || c.enter <= 0.0 || (c.enter_axis == 1 && (d.y > 0.0 || absorption.w == 0.0))) return n;
  const float towards = d[c.enter_axis];
  vec3 glass = vec3(0.0);
  glass[c.enter_axis] = -sign(towards);
  const float behind = (distance_m - c.enter) * abs(towards);
  bend *= smoothstep(1.0, 3.0, behind / radius);
  return normalize(mix(glass, n, smoothstep(0.1, 1.0, behind / radius) + 1e-4));
}

// The normal of a surface that meets the tank's walls, in world space: at a wall it has no part across the wall, since
// the wall mirrors the water. From one splatted radius off the wall on, and on steep water, it is n.
vec3 level_at_walls(vec3 n, vec3 position, float radius) {
  if (tank.w == 0.0) return n;
  const vec2 away = min(position.xz, tank.xz - position.xz) / radius;
  n.xz *= mix(vec2(1.0), smoothstep(0.0, 1.0, away), smoothstep(0.5, 0.8, n.y));
  return normalize(n);
}

// Opacity of a fluid pixel whose particle is smaller than the pixel: its share of the pixel, and more where its
// neighbours hold water too.
float small_cover(ivec2 pixel, float nearness_here, float radius) {
  const float radius_px = radius * nearness_here / rays.x;
  const bool is_small = radius_px <= 0.6;
  int fluid = 0;
  for (int k = is_small ? 0 : 9; k < 9; ++k) {
    const ivec2 near = clamp(pixel + ivec2(k % 3, k / 3) - 1, ivec2(0), size.xy - 1);
    fluid += int(nearness[near.y * size.x + near.x] > 0.0);
  }
  return !is_small ? 1.0 : max(3.1416 * radius_px * radius_px, float(fluid - 1) / 8.0);
}

#ifdef FOAM
// Light from white foam under sun and sky.
vec3 foam_light(vec3 n) { return vec3(0.42, 0.45, 0.48) + vec3(0.52, 0.50, 0.46) * max(dot(n, sun), 0.0); }

// Share of a pixel that foam covers; x: foam on the water or in front of it, y: foam below its surface.
vec2 foam_cover(int at) { return 1.0 - exp(-vec2(cover[2 * at], cover[2 * at + 1]) / foam_units); }
#endif

void main() {
#ifdef DRY
  const ivec2 pixel = dry_pixel();
#else
  const ivec2 pixel = wet_pixel();
#endif
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
  float frame = near_frame(crossing, eye, d, footprint_per_m, frame_at);
  const int at = pixel.y * size.x + pixel.x;
#ifdef DRY
  bool is_water = false;
  float nearest = 0.0;
#else
  bool is_water = nearness[at] > 0.0;
  float nearest = nearness[at];
#endif
#ifdef OBSTACLES
  const float obstacle_at = meet_obstacles(eye, d).at;
  if (is_water && obstacle_at < per_depth / nearness[at]) is_water = false;
  if (!is_water) nearest = per_depth / obstacle_at;
  if (obstacle_at < frame_at) frame = 0.0;
#endif
#ifdef FOAM
  const vec2 foam = foam_cover(at);
  vec3 foam_normal = vec3(0.0, 1.0, 0.0);
#endif
  Behind behind = Behind(eye, d, footprint_per_m, 0.0, 1.0, vec3(1.0), vec3(0.0));
  vec3 mirrored = vec3(0.0);
  float share = 0.0;
  if (is_water) {
    const float radius = max(normals[at].w * origin.w, 1e-4), distance_m = per_depth / nearness[at];
    float bend;
    const vec3 smoothed = mat3(eye_to_world) * shading_normal(pixel, at, ray, bend);
    const vec3 position = clamp(eye + distance_m * d, vec3(1e-3), min(tank_high(), vec3(1e4)) - vec3(1e-3));
    vec3 n = flat_at_glass(level_at_walls(smoothed, position, radius), crossing, d, distance_m, radius, bend);
#ifdef OBSTACLES
    // Water thinner than a splatted radius before a solid turns and mirrors less light, so that the waterline does not
    // show single particles.
    const float before_solid = smoothstep(0.0, radius, obstacle_at - distance_m);
    n = normalize(mix(-d, n, before_solid));
#endif
    const float length_m = water_length(xy), opacity = small_cover(pixel, nearness[at], radius);
    share = opacity * reflected_share(clamp(-dot(d, n), 0.0, 1.0)) * smoothstep(0.0, thin_m, length_m);
#ifdef OBSTACLES
    share *= before_solid;
#endif
    const bool at_glass = distance_m - crossing.enter < radius;
    mirrored = mirrored_light(position, d, n, at_glass, radius, footprint_per_m + 2.0 * bend, share);
    float wall_at = crossing.leave;
#ifdef OBSTACLES
    wall_at = min(wall_at, obstacle_at);
#endif
    const Behind wet =
        refracted(position, d, n, at_glass, bend, length_m, wall_at - distance_m, radius, footprint_per_m, distance_m);
    if (opacity == 1.0) behind = wet;
    behind.kept = mix(vec3(1.0), wet.kept, opacity);
    behind.added = opacity * wet.added;
#ifdef FOAM
    behind.kept *= 1.0 - 0.8 * foam.y;
    behind.added = mix(behind.added, vec3(0.60, 0.80, 0.84), 0.8 * foam.y);
    foam_normal = n;
#endif
    // Only water above the tank's rim, or leaked water, may hide the near side of the frame.
    if ((position.y > tank.y || tank.w == 0.0) && distance_m < 0.999 * frame_at) frame = 0.0;
  }
  vec3 light = seen(behind.from, behind.along, behind.footprint_per_m, behind.travelled, behind.framed);
  light = mix(light * behind.kept + behind.added, mirrored, share);
#ifdef FOAM
  light = mix(light, foam_light(foam_normal), foam.x);
  cover[2 * at] = floatBitsToUint(is_water ? foam.x : 0.0);  // for edges.comp
#endif
  if (frame > 0.5) nearest = max(nearest, per_depth / frame_at);
  light = mix(light, frame_colour, frame);
  shaded[at] = packed_light(light);
  shown[at] = nearest;
  imageStore(picture, pixel + ivec2(origin.xy), vec4(encode_srgb(light), 1.0));
}
