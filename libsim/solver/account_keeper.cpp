#include "libsim/solver/account_keeper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sim::SIM_BACKEND {

namespace {

/// Computes Extremes over all particles. Each lane reads particles at a fixed stride, so that adjacent lanes
/// of a warp read adjacent memory. A team first sums over its lanes, so that it needs only one atomic
/// operation per total.
struct Gather {
  const Vec4* velocity;
  const float* density;
  const std::uint8_t* level;
  const std::uint8_t* active;  ///< flags of the solved particles; nullptr if all were solved
  const int* id;
  int n, teams;
  int half;  ///< the frame's end as a time in half substeps since the frame's start (TroubleKey::of)
  Extremes* out;
#ifdef SIM_CUDA
  static constexpr int particles_a_team = 128;
#else
  static constexpr int particles_a_team = 32;
#endif

  template <class Team>
  SIM_FN void operator()(int number, Team team) const {
    float fastest = 0;
    float excess = 0;
    int mass = 0;
    for (int i = number * Team::size + team.rank(); i < n; i += teams * Team::size) {
      const Vec3 v = xyz(velocity[i]);
      const float speed2 = dot(v, v);
      fastest = fmaxf(fastest, speed2);
      if (!(speed2 <= std::numeric_limits<float>::max())) tell(Trouble::NotFinite, i);
      if (active && !active[i]) continue;
      if (!(density[i] <= Divergence::most_density)) tell(Trouble::TooDense, i);
      const int units = 1 << level[i];
      mass += units;
      excess += static_cast<float>(units) * fminf(fmaxf(density[i] - 1, 0.0f), 1.0f);
    }
    fastest = -team.min(-fastest);
    const auto units = team.sum(static_cast<std::uint64_t>(excess / Extremes::excess_unit));
    mass = team.sum(mass);
    if (team.rank() > 0) return;
    atomic_max(&out->fastest_bits, bits_of(sqrtf(fastest)));
    atomic_add(&out->excess, units);
    atomic_add(&out->mass, static_cast<std::uint64_t>(mass));
  }
  SIM_FN void tell(Trouble cause, int i) const {
    atomic_add(&out->troubled, std::uint64_t{1});
    atomic_max(&out->first, TroubleKey::of(half, cause, id[i]));
  }
  SIM_FN static int bits_of(float value) {
#ifdef __CUDA_ARCH__
    return __float_as_int(value);
#else
    return std::bit_cast<int>(value);
#endif
  }
};

/// Includes the speeds of free bodies in the largest speed.
struct FastestBody {
  const FreeBody* free;
  Extremes* out;
  SIM_FN void operator()(int b) const {
    if (free[b].mass > 0)
      atomic_max(&out->fastest_bits, Gather::bits_of(length(free[b].momentum) / free[b].mass));
  }
};

/// Fills FrameTally. Particles are sorted by level, so the number of particles of one level is the distance
/// between its two borders, found by bisection. The call for level 0 also copies the other values.
struct Tally {
  const Guards* guards;
  const NeighbourList::Need* lists;
  /// Points to the last prefix sum of the flags of solved particles: their number before particles left
  /// through outlets. nullptr if all were solved.
  const int* active;
  const std::uint8_t* level_of;
  int n;
  const Extremes* extremes;
  FrameTally* out;

  SIM_FN void operator()(int level) const {
    if (level >= LevelSupports::most) return;  // never true: silences compiler warnings
    out->by_level[level] = first_of(level + 1) - first_of(level);
    if (level > 0) return;
    out->guards = *guards;
    out->extremes = *extremes;
    out->lists = lists ? *lists : NeighbourList::Need{0, 0};
    out->active = active ? *active : n;
  }

  /// Index of the first particle of this level or a coarser one.
  SIM_FN int first_of(int level) const {
    if (level == 0) return 0;
    if (level == LevelSupports::most) return n;
    int first = 0, last = n;
    while (first < last) {
      const int middle = first + (last - first) / 2;
      if (level_of[middle] < level) {
        first = middle + 1;
      } else {
        last = middle;
      }
    }
    return first;
  }
};

/// Position of the particle with this id, m; none if the position is not finite or the id is unknown. Copies
/// all ids to the host, which is slow; a run calls this once at most, in its first frame with trouble.
std::optional<Vec3d> place_of(const Particles& particles, int id) {
  const std::vector<int> ids = particles.all().id.to_host();
  const auto found = std::find(ids.begin(), ids.end(), id);
  if (found == ids.end()) return {};
  Vec4 at;
  copy_to_host(&at, particles.all().position.data() + (found - ids.begin()), sizeof at);
  const Vec3d out{static_cast<double>(at.x), static_cast<double>(at.y), static_cast<double>(at.z)};
  if (!std::isfinite(out[0] + out[1] + out[2])) return {};
  return out;
}

GuardCounts difference(const GuardCounts& now, const GuardCounts& before) {
  return {now.speed_limited - before.speed_limited,
          now.coincident_pairs - before.coincident_pairs,
          now.not_finite - before.not_finite,
          now.neighbours_dropped - before.neighbours_dropped,
          now.wall_projected - before.wall_projected,
          now.nozzle_waited - before.nozzle_waited,
          now.saliency_not_finite - before.saliency_not_finite,
          now.gaze_lost - before.gaze_lost};
}

}  // namespace

GuardCounts guard_counts(const Guards& met, const FluidState& state) {
  return {
      met.speed_limited,  met.coincident_pairs, met.not_finite,          met.neighbours_dropped,
      met.wall_projected, state.jets.waited,    met.saliency_not_finite, state.saliency.input.gaze_lost()};
}

void AccountKeeper::begin(const std::vector<ParticleState>& start, int finest_level, int coarsest_level) {
  finest_level_ = finest_level;
  coarsest_level_ = coarsest_level;
  account_ = {};
  divergence_.reset();
  account_.particles_by_level.assign(static_cast<std::size_t>(coarsest_level - finest_level + 1), 0);
  for (const ParticleState& particle : start)
    ++account_.particles_by_level[static_cast<std::size_t>(particle.level - finest_level)];
}

FrameTally AccountKeeper::take(const FluidState& state, std::optional<TemporalReport> went_by, int frame) {
  const auto& a = state.activation;
  const bool left_out = a.columns_set && !a.all_marked;
  tally_.resize(1);
  extremes_.resize(1);
  extremes_.zero();
  const int n = state.particles.size();
  const int teams = (n + Gather::particles_a_team - 1) / Gather::particles_a_team;
  const auto& p = state.particles.all();
  for_each_team("gather extremes", teams,
                Gather{.velocity = p.velocity.data(),
                       .density = p.density.data(),
                       .level = p.level.data(),
                       .active = left_out && !a.rules.within_frame ? p.active.data() : nullptr,
                       .id = p.id.data(),
                       .n = n,
                       .teams = teams,
                       .half = 2 * state.parameters.substeps,
                       .out = extremes_.data()});
  if (state.obstacles.free.size() > 0)
    for_each("fastest body", state.obstacles.count(),
             FastestBody{state.obstacles.free.data(), extremes_.data()});
  for_each("frame tally", LevelSupports::most,
           Tally{.guards = state.guards.data(),
                 .lists = state.neighbours.need(),
                 .active = left_out && a.ranks.size() > 0 ? a.ranks.data() + (a.ranks.size() - 1) : nullptr,
                 .level_of = state.particles.all().level.data(),
                 .n = n,
                 .extremes = extremes_.data(),
                 .out = tally_.data()});
  const FrameTally tally = tally_.to_host()[0];
  account_.particles_by_level.assign(tally.by_level + finest_level_, tally.by_level + coarsest_level_ + 1);
  if (went_by) went_by->active = tally.active;
  account_.temporal = went_by;
  const GuardCounts met = guard_counts(tally.guards, state);
  account_.guards = difference(met, met_);
  met_ = met;
  look_for_trouble(state, tally, frame);
  return tally;
}

void AccountKeeper::look_for_trouble(const FluidState& state, const FrameTally& tally, int frame) {
  const std::uint64_t first = std::max(tally.guards.first, tally.extremes.first);
  if (first == 0) return;
  if (!divergence_) {
    divergence_ = Divergence{
        .frame = frame, .particle = TroubleKey::id(first), .cause = TroubleKey::cause(first), .where_m = {}};
    divergence_->where_m = place_of(state.particles, divergence_->particle);
  }
  const GuardCounts& met = *account_.guards;
  divergence_->count += met.not_finite + met.speed_limited + met.neighbours_dropped + met.coincident_pairs +
                        tally.extremes.troubled;
}

}  // namespace sim::SIM_BACKEND
