#include "libsim/surface/ellipsoids.hpp"

#include <algorithm>

namespace sim::SIM_BACKEND {

namespace {

struct CopyForSurface {
  const Vec4* from;
  Vec4* predicted;
  Vec4* position;
  Vec4* velocity;
  std::uint8_t* level;
  int* id;
  SIM_FN void operator()(int i) const {
    predicted[i] = position[i] = velocity[i] = from[i];
    level[i] = 0;
    id[i] = i;
  }
};

/// Walls of the tank that are near a particle: the planes that mirror the water.
struct NearWalls {
  Vec3 twice;     ///< per axis, twice the offset from the particle to the wall, in supports
  unsigned axes;  ///< a bit per axis

  SIM_FN NearWalls(const Domain& tank, Vec4 self, float reach) : twice{}, axes(0) {
    const float inverse = 1 / self.w;
    take(0, tank.low.x - self.x, tank.high.x - self.x, inverse, reach, twice.x);
    take(1, tank.low.y - self.y, tank.high.y - self.y, inverse, reach, twice.y);
    take(2, tank.low.z - self.z, tank.high.z - self.z, inverse, reach, twice.z);
  }
  SIM_FN void take(int axis, float low, float high, float inverse, float reach, float& to) {
    const float wall = (-low < high ? low : high) * inverse;
    if (!(fabsf(wall) < reach)) return;
    to = 2 * wall;
    axes |= 1u << axis;
  }
  SIM_FN Vec3 mirrored(Vec3 offset, unsigned image) const {
    return {image & 1u ? twice.x - offset.x : offset.x, image & 2u ? twice.y - offset.y : offset.y,
            image & 4u ? twice.z - offset.z : offset.z};
  }
};

/// The drawn ellipsoids of two frames, by id.
struct Memory {
  const int* id = nullptr;            ///< nullptr: no memory
  const Vec4* last_centre = nullptr;  ///< nullptr: no last picture
  const RenderShape* last_shape = nullptr;
  const Vec4* last_motion = nullptr;
  Vec4* centre = nullptr;
  RenderShape* shape = nullptr;
  Vec4* motion = nullptr;
  float follow = 1;

  /// Blends the ellipsoid of particle i with that of the last picture, and stores it for the next one.
  SIM_FN Ellipsoid blend(const SurfaceRules& rules, int i, Vec3 place, float r, Vec3 way,
                         Ellipsoid drawn) const {
    if (!id) return drawn;
    const int k = id[i];
    if (last_centre) {
      const Vec4 last = last_centre[k];
      const Ellipsoid then{xyz(last) + way - place, unpacked(last_shape[k]), last_motion[k].w};
      drawn = blended(rules, drawn, then, last.w, r, follow, blend_share(rules, r, way));
    }
    centre[k] = with_w(place + drawn.centre, r);
    shape[k] = packed(drawn.square);
    motion[k] = with_w(way, drawn.radius);
    return drawn;
  }
};

/// Marks the ids of particles that have gone and still fade out.
struct MarkFading {
  SurfaceRules rules;
  Memory memory;
  std::uint8_t* fades;
  SIM_FN void operator()(int k) const {
    const float last = memory.last_centre[k].w;
    const Vec4 motion = memory.last_motion[k];
    fades[k] =
        memory.centre[k].w == 0 && (last < 0 ? last > 1 - static_cast<float>(rules.fading)
                                             : last > 0 && blend_share(rules, motion.w, xyz(motion)) > 0);
  }
};

/// Draws the particles that fade out behind the n others, in the order of their ids: they move on and shrink.
struct DrawFading {
  SurfaceRules rules;
  Memory memory;
  const std::uint8_t* fades;
  const int* count;
  int n;
  Vec4* centre;
  RenderShape* shape;
  SIM_FN void operator()(int k) const {
    if (!fades[k]) return;
    const Vec4 last = memory.last_centre[k];
    const Vec4 motion = memory.last_motion[k];
    const bool first = last.w > 0;
    const float age = first ? 1 : 1 - last.w;
    const auto whole = static_cast<float>(rules.fading);
    const float share = first ? blend_share(rules, motion.w, xyz(motion)) : 1.0f;
    const Vec3 place = xyz(last) + xyz(motion);
    const RenderShape left =
        packed((share * (whole - age) / (whole - age + 1)) * unpacked(memory.last_shape[k]));
    memory.centre[k] = with_w(place, -age);
    memory.shape[k] = left;
    memory.motion[k] = motion;
    const int at = n + count[k] - 1;
    centre[at] = with_w(place, motion.w);
    shape[at] = left;
  }
};

struct ShapeOne {
  SurfaceRules rules;
  Memory memory;
  CellTable cells;
  const Vec4* place;
  const int* slot;
  const Vec4* velocity;
  float frame_s, support;
  Domain tank;
  Vec4* centre;
  RenderShape* shape;

  template <class Team>
  struct Sum {
    const ShapeOne& task;
    Vec4 self;
    NearWalls walls;
    Team team;
    SurfaceMoments sum;
    SIM_FN void operator()(int from, int to) {
      const float inverse = 1 / self.w;
      for (int j = from + team.rank(); j < to; j += Team::size) {
        const Vec4 other = task.place[j];
        const Vec3 offset = inverse * (xyz(other) - xyz(self));
        const float size = other.w * inverse;
        sum.add(task.rules, offset, size);
        for (unsigned image = 1; image < 8 && walls.axes; ++image)
          if ((image & ~walls.axes) == 0) sum.add(task.rules, walls.mirrored(offset, image), size);
      }
    }
  };

  template <class Team>
  SIM_FN void operator()(int k, Team team) const {
    const Vec4 self = place[k];
    const int i = slot[k];
    if (!(self.w > 0)) {
      if (team.rank() == 0) {
        centre[i] = self;
        shape[i] = {};
      }
      return;
    }
    Sum<Team> task{*this, self, NearWalls(tank, self, rules.reach), team, {}};
    // The grid's margin is a share of the mean of both supports.
    const float margin = 2 * rules.reach * self.w / (self.w + support);
    cells.around(self, margin, [&task](int from, int to) { task(from, to); });
    SurfaceMoments sum;
    sum.mass = team.sum(task.sum.mass);
    sum.crowd = team.sum(task.sum.crowd);
    sum.first = {team.sum(task.sum.first.x), team.sum(task.sum.first.y), team.sum(task.sum.first.z)};
    const Symmetric3& s = task.sum.second;
    sum.second = {team.sum(s.xx), team.sum(s.yy), team.sum(s.zz),
                  team.sum(s.xy), team.sum(s.xz), team.sum(s.yz)};
    if (team.rank() != 0) return;
    const Vec3 way = velocity ? frame_s * xyz(velocity[i]) : Vec3{0, 0, 0};
    const float r = 0.25f * self.w;
    const Ellipsoid drawn = memory.blend(rules, i, xyz(self), r, way, ellipsoid_of(rules, sum, self.w, way));
    centre[i] = with_w(xyz(self) + drawn.centre, drawn.radius);
    shape[i] = packed(drawn.square);
  }
};

}  // namespace

/// Makes the last picture's ellipsoids those before, and room for the present ones.
void Ellipsoids::begin_frame(const SurfaceParticles& from) {
  if (from.frame != now_.frame) std::swap(before_, now_);
  now_.frame = from.frame;
  const auto ids = static_cast<std::size_t>(from.most_ids);
  now_.centre.resize(ids);
  now_.shape.resize(ids);
  now_.motion.resize(ids);
  now_.centre.zero();
}

int Ellipsoids::compute(const SurfaceParticles& from, Vec4* centre, RenderShape* shape) {
  if (from.n == 0) return 0;
  if (from.n > sorted_.capacity()) {
    sorted_.allocate(
        columns(Column::Position, Column::Velocity, Column::Id, Column::Level, Column::Predicted), from.n,
        from.n + from.n / 4);
  }
  sorted_.resize(from.n);
  ColumnArrays& to = sorted_.all();
  for_each("copy for surface", from.n,
           CopyForSurface{from.position, to.predicted.data(), to.position.data(), to.velocity.data(),
                          to.level.data(), to.id.data()});
  // Cells as wide as a support: most search radii reach into the adjacent cells only.
  grid_.build(sorted_, 1, from.tank, from.support);
  const SurfaceRules rules;
  Domain mirrors = from.tank;
  if (!from.lid) mirrors.high.y = 1e30f;
  Memory memory;
  if (from.id) {
    begin_frame(from);
    const bool known = before_.frame >= 0 && from.frame == before_.frame + 1 &&
                       before_.centre.size() == static_cast<std::size_t>(from.most_ids);
    memory = {.id = from.id,
              .last_centre = known ? before_.centre.data() : nullptr,
              .last_shape = before_.shape.data(),
              .last_motion = before_.motion.data(),
              .centre = now_.centre.data(),
              .shape = now_.shape.data(),
              .motion = now_.motion.data(),
              .follow = from.follow};
  }
  for_each_team("ellipsoids", from.n,
                ShapeOne{.rules = rules,
                         .memory = memory,
                         .cells = grid_.cells(),
                         .place = to.predicted.data(),
                         .slot = to.id.data(),
                         .velocity = from.velocity,
                         .frame_s = from.frame_s,
                         .support = from.support,
                         .tank = mirrors,
                         .centre = centre,
                         .shape = shape});
  if (!memory.last_centre) return from.n;
  const int ids = from.most_ids;
  fades_.resize(static_cast<std::size_t>(ids));
  for_each("mark fading", ids, MarkFading{rules, memory, fades_.data()});
  scanner_.inclusive_count(fades_.data(), ids, count_);
  for_each("draw fading", ids,
           DrawFading{rules, memory, fades_.data(), count_.data(), from.n, centre, shape});
  return from.n + last_of(count_);
}

void Ellipsoids::read(const SurfaceParticles& from, std::vector<RenderParticle>& particles,
                      std::vector<RenderShape>& shapes) {
  static_assert(sizeof(RenderParticle) == sizeof(Vec4));
  const auto room = static_cast<std::size_t>(std::max(from.n, from.most_ids));
  centre_.resize(room);
  shape_.resize(room);
  const auto n = static_cast<std::size_t>(compute(from, centre_.data(), shape_.data()));
  particles.resize(n);
  copy_to_host(particles.data(), centre_.data(), n * sizeof(Vec4));
  shapes.resize(n);
  copy_to_host(shapes.data(), shape_.data(), n * sizeof(RenderShape));
}

}  // namespace sim::SIM_BACKEND
