// Two maps for the light on the floor, both over the plane y = 0. A cell of the surface map is a ray of sunlight: its
// position is where the ray would meet the floor without water. A cell of the floor map is a square of the floor.
layout(std140, binding = 1) uniform FloorMaps {
  vec4 tank;          // xyz: inner size, m; w: unit of heights in the surface map, m
  ivec4 cells;        // number of cells along x and z; xy: surface map, zw: floor map
  vec4 surface_grid;  // xy: low corner x, z, m; z: edge of a cell, m; w: splatted radius / particle radius
  vec4 floor_grid;    // x: edge of a cell, m; y: units per m of chord; z: m of water per unit; w: standard
                      // deviation of the surface's smoothing, particle radii
  vec4 strength;      // of the picture effects, 0 to 1: x shadows, y caustics
  vec4 absorption;    // by water of red, green and blue, 1/m
} maps;

const vec2 leans = sun.xz / sun.y;  // horizontal shift of a ray of sunlight (x, z) per metre of height, in air

vec2 place_of(ivec2 cell) { return maps.surface_grid.xy + (vec2(cell) + 0.5) * maps.surface_grid.z; }

// Sunlight in water below a flat surface: horizontal shift (x, z) per metre of height, and path length per metre of
// depth.
const vec2 leans_in_water =
    sun.xz * into_water * inversesqrt(1.0 - into_water * into_water * (1.0 - sun.y * sun.y));
const float way_per_depth = inversesqrt(1.0 - into_water * into_water * (1.0 - sun.y * sun.y));

// Separates pools from spray by the share of a ray's path below the surface (light_smooth.comp) that lies in water:
// returns 1 from a share of 0.8 on (pool), 0 up to 0.4 (spray, jets).
float pool_share(vec4 surface) {
  return surface.y > 0.0 ? smoothstep(0.4, 0.8, surface.z * sun.y / max(surface.x, 1e-6)) : 0.0;
}
