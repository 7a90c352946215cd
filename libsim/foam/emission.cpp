#include "libsim/foam/motion.hpp"

#include "libsim/foam/water_round.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Uniform random number in [0, 1); `which` numbers the draws of one diffuse particle.
SIM_FN float draw(std::uint32_t seed, std::uint32_t which) { return uniform_of(random_bits(seed, which)); }

SIM_FN float specific_energy(Vec3 v) { return 0.5f * dot(v, v); }

/// The sum -sum_j V_j grad W_ij (V_j: volume), which points out of the water: -grad W points from j to i.
struct SumSurface {
  Vec4 self;
  int i;
  Vec3 normal{};

  SIM_FN void operator()(int j, Vec4 other) {
    const float h = 0.5f * (self.w + other.w);
    const Vec3 offset = xyz(self) - xyz(other);
    const float r2 = dot(offset, offset);
    if (j == i || r2 >= h * h) return;
    const Kernel kernel(h);
    const float volume = mass_of(other.w, 1);
    const float t = kernel.h2 - r2;
    normal += 6 * volume * kernel.poly6 * t * t * offset;
  }
};

/// Computes the outward normal n_i = -h_i sum_j V_j grad W_ij, as if water continued behind walls and in
/// obstacles, and samples the closing speed of the water divided by the distance (MeetingCells::meeting).
/// Both are 0 for water that is too slow or too coarse to foam.
template <class Bounds>
struct Surface {
  const Vec4* position;
  const Vec4* velocity;
  WaterRound water;
  Bounds bounds;
  Potential energy;
  const std::uint8_t* level;
  int coarsest_seen;
  GridFrame cells;
  const Vec4* meeting;
  Vec4* normal;
  float* approach;

  SIM_FN void operator()(int i) const {
    normal[i] = {0, 0, 0, 0};
    approach[i] = 0;
    // The particle is so coarse that it emits no foam and has no neighbour that emits foam.
    if (level[i] > coarsest_seen) return;
    if (!(energy(specific_energy(xyz(velocity[i]))) > 0)) return;
    const Vec4 self = position[i];
    SumSurface sum{.self = self, .i = i};
    water.with_pairs(self, sum);
    Vec3 wall;
    bounds.missing(xyz(self), self.w, wall);
    normal[i] = with_w(self.w * (sum.normal - wall), 0);
    approach[i] = sample(meeting, 0, cells.corners(xyz(self))).x;
  }
};

/// least_normal: minimum |n| of surface particles. least_push: minimum cosine between velocity and n for a
/// particle that moves the surface outwards (Ihmsen et al. 2012, Eq. 6).
constexpr float least_normal = 0.3f;
constexpr float least_push = 0.6f;

/// Mean, weighted by kernel and mass, over surface neighbours j of (1 - n_i n_j) / r_ij below the tangent
/// plane and 0 above it: convex crests count, troughs do not (Ihmsen et al. 2012, Eq. 4 and 5, divided by the
/// distance r_ij). n: unit normals.
struct SumCurvature {
  Vec4 self;
  Vec3 out;
  const Vec4* normal;
  float curved = 0;
  float weight = 0;

  SIM_FN void operator()(int j, Vec4 other) {
    const float h = 0.5f * (self.w + other.w);
    const Vec3 offset = xyz(self) - xyz(other);
    const float r2 = dot(offset, offset);
    if (r2 >= h * h || r2 <= coincident * coincident * h * h) return;
    const Vec3 n = xyz(normal[j]);
    const float size = length(n);
    if (size < least_normal) return;
    const float share = mass_of(other.w, 1) * Kernel(h).density(r2);
    weight += share;
    if (dot(offset, out) > 0) curved += share * (1 - dot(out, n) / size) / sqrtf(r2);
  }
};

/// Number of diffuse particles that each water particle emits: the emitted volume divided by the volume of a
/// diffuse particle, randomly rounded.
struct CountFoamBirths {
  const Vec4* position;
  const Vec4* velocity;
  const Vec4* normal;
  const int* id;
  const std::uint8_t* level;
  const float* approach;
  WaterRound water;
  FoamRules rules;
  std::uint32_t frame;
  int* births;

  SIM_FN void operator()(int i) const {
    births[i] = 0;
    const float energy = rules.energy(specific_energy(xyz(velocity[i])));
    if (!(energy > 0) || level[i] > rules.coarsest) return;
    const float potential = energy * (rules.approach(approach[i]) + rules.crest_depth * crest(i));
    const float volume = rules.rate * rules.dt * potential * mass_of(position[i].w, 1);
    const std::uint32_t chance = random_bits(static_cast<std::uint32_t>(id[i]), frame, 0xf0a3u);
    births[i] = static_cast<int>(volume / rules.volume + uniform_of(chance));
  }

  /// Potential of a convex surface that moves outwards, times the surface's area per volume of the particle,
  /// 1/m; 0 elsewhere. Crests emit in proportion to their area, because the area does not depend on the
  /// resolution.
  SIM_FN float crest(int i) const {
    const Vec3 n = xyz(normal[i]);
    const float size = length(n);
    if (size < least_normal) return 0;
    const Vec3 out = (1 / size) * n;
    const Vec3 v = xyz(velocity[i]);
    if (dot(v, out) < least_push * length(v)) return 0;
    const Vec4 self = position[i];
    SumCurvature sum{.self = self, .out = out, .normal = normal};
    water.with_pairs(self, sum);
    return sum.weight > 0 ? rules.crest(sum.curved / sum.weight) * size / self.w : 0;
  }
};

struct MarkFreeFoam {
  const Vec4* place;
  int* free;
  SIM_FN void operator()(int slot) const { free[slot] = !(place[slot].w > 0); }
};

/// Fills the free slots, in ascending order, with the emitted particles.
template <class Bounds>
struct Emit {
  const Vec4* position;
  const Vec4* velocity;
  const int* id;
  const float* approach;
  const int* births;
  const int* sums;
  int water;  ///< number of water particles
  const int* free;
  const int* free_of;
  int capacity;
  Bounds bounds;
  FoamRules rules;
  std::uint32_t frame;
  Vec4* place;
  Vec4* foam_velocity;

  SIM_FN void operator()(int slot) const {
    if (!free[slot]) return;
    const int rank = free_of[slot] - 1;
    const int asked = sums[water - 1];
    const int room = free_of[capacity - 1];
    if (rank >= asked) return;
    // If more particles are requested than slots are free, the emitted particles are spread evenly over the
    // requests.
    const int k = asked <= room ? rank : static_cast<int>(static_cast<std::int64_t>(rank) * asked / room);
    const int i = parent_of(k);
    put(slot, i, k - (sums[i] - births[i]));
  }

  /// The water particle that emits the k-th diffuse particle: the first index whose inclusive sum exceeds k.
  SIM_FN int parent_of(int k) const {
    int low = 0;
    int high = water - 1;
    while (low < high) {
      const int middle = (low + high) / 2;
      if (sums[middle] > k) {
        high = middle;
      } else {
        low = middle + 1;
      }
    }
    return low;
  }

  /// Stores the c-th diffuse particle of water particle i in `slot`: at a random position in the cylinder
  /// that particle i swept in this frame (Ihmsen et al. 2012, Fig. 4). Its speed away from the cylinder's
  /// axis is its distance from the axis times `approach`.
  SIM_FN void put(int slot, int i, int c) const {
    const std::uint32_t seed =
        random_bits(static_cast<std::uint32_t>(id[i]), frame, static_cast<std::uint32_t>(c));
    const Vec4 parent = position[i];
    const Vec3 v = xyz(velocity[i]);
    const float speed = length(v);
    const Vec3 axis = speed > 0 ? (1 / speed) * v : Vec3{0, 1, 0};
    // Two directions perpendicular to the axis (Duff et al. 2017).
    const float sign = axis.z < 0 ? -1.0f : 1.0f;
    const float a = -1 / (sign + axis.z);
    const float b = axis.x * axis.y * a;
    const Vec3 e1{1 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x};
    const Vec3 e2{b, sign + axis.y * axis.y * a, -axis.y};
    const float radius = 0.25f * parent.w * sqrtf(draw(seed, 0));
    const float angle = 2 * pi * draw(seed, 1);
    const Vec3 across = radius * (cosf(angle) * e1 + sinf(angle) * e2);
    Vec3 x = xyz(parent) + across - (rules.dt * draw(seed, 2)) * v;
    bounds.project(x, xyz(parent), 0);
    place[slot] = with_w(x, rules.lifetime * (0.5f + draw(seed, 3)));
    foam_velocity[slot] = with_w(v + approach[i] * across, 1);
  }
};

struct Enter {
  const int* sums;
  const int* free_of;
  int water, capacity;
  FoamLedger* ledger;
  SIM_FN void operator()(int) const {
    const auto asked = static_cast<std::uint64_t>(sums[water - 1]);
    const auto room = static_cast<std::uint64_t>(free_of[capacity - 1]);
    ledger->emitted += asked;
    if (asked > room) ledger->dropped += asked - room;
  }
};

}  // namespace

template <class Bounds>
void find_foam_surface(FoamPool& pool, FoamView water, const Grid& grid, const Bounds& bounds,
                       const FoamRules& rules) {
  for_each("foam surface", water.size(),
           Surface<Bounds>{.position = water.position(),
                           .velocity = water.velocity(),
                           .water = {grid.cells(), water.position()},
                           .bounds = bounds,
                           .energy = rules.energy,
                           .level = water.level(),
                           .coarsest_seen = rules.coarsest_seen,
                           .cells = pool.cells.grid,
                           .meeting = pool.cells.meeting.data(),
                           .normal = water.normal(),
                           .approach = pool.approach.data()});
}

void count_foam_births(FoamPool& pool, FoamView water, const Grid& grid, const FoamRules& rules) {
  pool.births.resize(static_cast<std::size_t>(water.size()));
  for_each("foam potentials", water.size(),
           CountFoamBirths{.position = water.position(),
                           .velocity = water.velocity(),
                           .normal = water.normal(),
                           .id = water.id(),
                           .level = water.level(),
                           .approach = pool.approach.data(),
                           .water = {grid.cells(), water.position()},
                           .rules = rules,
                           .frame = pool.frame,
                           .births = pool.births.data()});
}

template <class Bounds>
void emit_foam(FoamPool& pool, FoamView water, const Bounds& bounds, const FoamRules& rules) {
  pool.scanner.inclusive_sum(pool.births, pool.sums);
  for_each("free foam", pool.capacity(), MarkFreeFoam{pool.place.data(), pool.free.data()});
  pool.scanner.inclusive_sum(pool.free, pool.free_of);
  for_each("emit foam", pool.capacity(),
           Emit<Bounds>{.position = water.position(),
                        .velocity = water.velocity(),
                        .id = water.id(),
                        .approach = pool.approach.data(),
                        .births = pool.births.data(),
                        .sums = pool.sums.data(),
                        .water = water.size(),
                        .free = pool.free.data(),
                        .free_of = pool.free_of.data(),
                        .capacity = pool.capacity(),
                        .bounds = bounds,
                        .rules = rules,
                        .frame = pool.frame,
                        .place = pool.place.data(),
                        .foam_velocity = pool.velocity.data()});
  for_each("enter foam", 1,
           Enter{.sums = pool.sums.data(),
                 .free_of = pool.free_of.data(),
                 .water = water.size(),
                 .capacity = pool.capacity(),
                 .ledger = pool.ledger.data()});
}

#define SIM_FOR_BOUNDS(Bounds)                                                                        \
  template void find_foam_surface(FoamPool&, FoamView, const Grid&, const Bounds&, const FoamRules&); \
  template void emit_foam(FoamPool&, FoamView, const Bounds&, const FoamRules&);
SIM_FOR_BOUNDS(Walls)
SIM_FOR_BOUNDS(Solids)
#undef SIM_FOR_BOUNDS

}  // namespace sim::SIM_BACKEND
