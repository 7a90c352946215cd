// Obstacles that are meshes: signed distances, m, at the nodes of one grid per mesh.
layout(std430, binding = 5) readonly buffer ObstacleGrids {
  // Eight words per obstacle: low corner x, y, z and step (floats, m), nodes along x, y, z, index of the first
  // distance. The distances of all grids (floats) follow.
  uint obstacle_grids[];
};

const int most_mesh_steps = 96;
const int halvings = 8;  // bisections of the step that enters the mesh

struct MeshGrid {
  vec3 low;
  float step;
  ivec3 nodes;
  int first;
};

float grid_float(int at) { return uintBitsToFloat(obstacle_grids[at]); }

MeshGrid mesh_grid(int k) {
  const int at = 8 * k;
  const vec3 low = vec3(grid_float(at), grid_float(at + 1), grid_float(at + 2));
  const ivec3 nodes = ivec3(obstacle_grids[at + 4], obstacle_grids[at + 5], obstacle_grids[at + 6]);
  return MeshGrid(low, grid_float(at + 3), nodes, int(obstacle_grids[at + 7]));
}

// Signed distance at p, interpolated trilinearly; outside the grid, that of the grid's nearest point.
float mesh_distance(MeshGrid grid, vec3 p) {
  const vec3 cells = clamp((p - grid.low) / grid.step, vec3(0.0), vec3(grid.nodes - 1));
  const ivec3 cell = min(ivec3(cells), grid.nodes - 2);
  const vec3 f = cells - vec3(cell);
  const int at = grid.first + (cell.z * grid.nodes.y + cell.y) * grid.nodes.x + cell.x;
  const int up = at + grid.nodes.x, back = at + grid.nodes.x * grid.nodes.y, both = back + grid.nodes.x;
  const vec4 low = vec4(grid_float(at), grid_float(up), grid_float(back), grid_float(both));
  const vec4 high = vec4(grid_float(at + 1), grid_float(up + 1), grid_float(back + 1), grid_float(both + 1));
  const vec4 along = mix(low, high, f.x);
  const vec2 across = mix(along.xz, along.yw, f.y);
  return mix(across.x, across.y, f.z);
}

// Unit normal at p from the distances at four points around it, the corners of a tetrahedron.
vec3 mesh_normal(MeshGrid grid, vec3 p) {
  vec3 slope = vec3(0.0);
  for (int corner = 0; corner < 4; ++corner) {
    const vec3 way = vec3(corner == 0 || corner == 1 ? 1.0 : -1.0, corner == 0 || corner == 2 ? 1.0 : -1.0,
                          corner == 0 || corner == 3 ? 1.0 : -1.0);
    slope += mesh_distance(grid, p + grid.step * way) * way;
  }
  return dot(slope, slope) > 0.0 ? normalize(slope) : vec3(0.0, 1.0, 0.0);
}

// Distance along a ray to the point where it enters the mesh; -1 if it does not. Each step is as long as the distance
// from the surface, but at least half a cell. The step that ends inside the mesh is bisected to find the point.
float meet_mesh(MeshGrid grid, vec3 o, vec3 d) {
  const vec3 safe = mix(d, vec3(1e-9), lessThan(abs(d), vec3(1e-9)));
  const vec3 high = grid.low + grid.step * vec3(grid.nodes - 1);
  const vec3 a = (grid.low - o) / safe, b = (high - o) / safe;
  const vec3 near = min(a, b), far = max(a, b);
  const float leave = min(far.x, min(far.y, far.z));
  float at = max(max(near.x, max(near.y, near.z)), 0.0);
  float before = at, inside_at = never;
  int halves_left = halvings;
  bool outside = false;
  for (int k = 0; k < most_mesh_steps && at < leave && halves_left > 0; ++k) {
    const float away = mesh_distance(grid, o + at * d);
    if (away <= 0.0 && outside) {
      inside_at = at;
    } else {
      outside = away > 0.0;
      before = at;
    }
    if (inside_at < never) {
      --halves_left;
      at = 0.5 * (before + inside_at);
    } else {
      at += max(abs(away), 0.5 * grid.step);
    }
  }
  return inside_at < never ? inside_at : -1.0;
}
