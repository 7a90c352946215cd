// Two maps for the light on the floor, both over the plane y = 0. The surface map has a cell for a ray of sunlight,
// named for the place where it would meet the floor through air alone. The floor map has a cell for a piece of floor.
layout(std140, binding = 1) uniform FloorMaps {
  vec4 tank;          // size, m; unit of heights in the surface map, m
  ivec4 cells;        // of the surface map and of the floor map, x and z
  vec4 surface_grid;  // low corner x, z and a cell's edge, m; radius of splatted spheres / particle radius
  vec4 floor_grid;    // a cell's edge, m; units of thickness per m; m of water per unit; standard deviation of
                      // the surface's smoothing in particle radii
  vec4 strength;      // of the picture effects, in the registry's order
  vec4 absorption;    // by water, red, green and blue, per m
} maps;

const vec2 leans = sun.xz / sun.y;  // m aside for a metre up along sunlight

vec2 place_of(ivec2 cell) { return maps.surface_grid.xy + (vec2(cell) + 0.5) * maps.surface_grid.z; }

// Sunlight in water below a flat surface: m aside for a metre up, and the way for a metre of depth.
const vec2 leans_in_water =
    sun.xz * into_water * inversesqrt(1.0 - into_water * into_water * (1.0 - sun.y * sun.y));
const float way_per_depth = inversesqrt(1.0 - into_water * into_water * (1.0 - sun.y * sun.y));

// How much of the way of a ray below the surface (light_smooth.comp) is water, as a switch: 1 in a pool, 0 through
// spray and jets.
float pool_share(vec4 surface) {
  return surface.y > 0.0 ? smoothstep(0.4, 0.8, surface.z * sun.y / max(surface.x, 1e-6)) : 0.0;
}
