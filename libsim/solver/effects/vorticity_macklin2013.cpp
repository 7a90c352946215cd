/// Vorticity confinement: restores the swirl that a method's numerical viscosity removes.

#include "libsim/solver/effects/loops/curl.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Share of |omega|, the length of a particle's curl of the velocity. If h times the gradient of |omega| is
/// smaller than this share, the gradient's direction is uncertain, and the confinement is weakened.
constexpr float least_slope = 0.03f;

/// The mean of omega, the curl of the velocity, over the neighbours and the particle, weighted by poly6's
/// slope over distance; its length in w. The curls of single particles are noisy, most where levels meet, and
/// the gradient of noisy values has a random direction.
struct Smooth {
  static constexpr int sums = 4;
  const Vec4* curl;
  Vec4* smooth;
  float widest;  ///< largest support of particles on which the effect acts, m

  SIM_FN bool takes(float h) const { return h <= widest; }
  using Self = Vec4;  ///< the particle's omega
  SIM_FN Self self(int i) const { return curl[i]; }
  SIM_FN void add(const NeighbourPair& pair, Self, float& x, float& y, float& z, float& whole) const {
    const Vec4 there = curl[pair.j];
    const float weight = there.w < 0 ? 0.0f : pair.slope;
    x += weight * there.x;
    y += weight * there.y;
    z += weight * there.z;
    whole += weight;
  }
  SIM_FN void finish(int i, Vec4 at, Self own, float x, float y, float z, float whole) const {
    const float weight = Kernel(at.w).poly6 * at.w * at.w * at.w * at.w;
    const Vec3 mean = (1 / (whole + weight)) * (Vec3{x, y, z} + weight * xyz(own));
    smooth[i] = with_w(mean, length(mean));
  }
  SIM_FN void skip(int i) const { smooth[i] = {0, 0, 0, Curl::unknown}; }
};

/// dv / dt = c f N x omega with omega the particle's curl and N the normalised gradient of the smoothed
/// |omega| (Smooth). c is a speed, so that the force on a volume does not depend on its particles. The flow
/// around the axis of a Lamb-Oseen vortex gains speed at the rate c omega(r). f limits the force to rotation
/// rates between `from` and `most`, so that still water stays still and swirl stays bounded. The change of
/// momentum is recorded as Change::Effects; angular momentum increases.
struct Confine {
  static constexpr int sums = 3;
  const Vec4* curl;
  const Vec4* smooth;
  Vec4* velocity;
  float kick;  ///< c dt, m
  float from, most;
  float widest;  ///< largest support of particles on which the effect acts, m

  SIM_FN bool takes(float h) const { return h <= widest; }
  using Self = float;  ///< the particle's |mean of omega|
  SIM_FN Self self(int i) const { return smooth[i].w; }
  /// Adds a neighbour's part of grad |omega|, divided by 6 V_i.
  SIM_FN void add(const NeighbourPair& pair, Self own, float& x, float& y, float& z, float&) const {
    const float there = smooth[pair.j].w;
    const float along = there < 0 ? 0.0f : pair.slope * (there - own);
    x -= along * pair.x;
    y -= along * pair.y;
    z -= along * pair.z;
  }
  SIM_FN void finish(int i, Vec4 at, Self, float x, float y, float z, float) const {
    const Vec4 omega = curl[i];
    const float share = omega.w > 0 ? fed(omega.w) : 0;
    if (!(share > 0)) return;
    const Vec3 slope = (6 * mass_of(at.w, 1) * at.w) * Vec3{x, y, z};
    const float least = least_slope * omega.w;
    const Vec3 n = (1 / sqrtf(dot(slope, slope) + least * least)) * slope;
    velocity[i] = with_w(xyz(velocity[i]) + (share * kick) * cross(n, xyz(omega)), 0);
  }
  SIM_FN void skip(int) const {}

 private:
  /// The factor f: rises from 0 at `from` to 1 at 2 `from`, and falls from 1 at `most` / 2 to 0 at `most`.
  SIM_FN float fed(float omega) const {
    const float rise = omega - from;
    const float begins = rise >= from ? 1.0f : at_least(rise, 0.0f) / from;
    return begins * at_most(at_least(2 - 2 * omega / most, 0.0f), 1.0f);
  }
};

/// Copies the smoothed |omega| to the column that saliency reads. Unsolved particles keep their last value;
/// particles too coarse for the effect get 0.
struct Show {
  const Vec4* smooth;
  const std::uint8_t* level;
  float* swirl;
  int coarsest;  ///< coarsest level on which the effect acts

  SIM_FN void operator()(int i) const {
    const float turns = smooth[i].w;
    if (level[i] > coarsest) {
      swirl[i] = 0;
    } else if (turns >= 0) {
      swirl[i] = turns;
    }
  }
};

void find_curl(FluidState& state, CurlView p) { run_pair_loop("vorticity", state, p, curl_of(state, p)); }

using SmoothView =
    ColumnView<columns(Column::Position, Column::Neighbours, Column::Normal), columns(Column::VelocityNext)>;

void smooth_curl(FluidState& state, SmoothView p) {
  run_pair_loop("smooth curl", state, p,
                Smooth{.curl = p.normal(),
                       .smooth = p.velocity_next(),
                       .widest = state.widest_support(EffectOption::VorticityCoarsest)});
}

using ShowView = ColumnView<columns(Column::Level, Column::VelocityNext), columns(Column::Swirl)>;

std::string if_seen(const Demand& demand) {
  const bool counts = coefficients_of(demand.effects)[EffectOption::VorticitySaliency] > 0;
  return demand.saliency && counts ? "saliency sees it" : "";
}

/// Runs in a frame's last substep, because saliency reads the swirl at most once per frame. It runs in every
/// frame: a gaze jump may trigger a level update in the next one.
void show_swirl(FluidState& state, ShowView p) {
  const auto& k = state.parameters;
  if (state.substep + 1 < k.substeps) return;
  for_each("swirl", p.size(),
           Show{.smooth = p.velocity_next(),
                .level = p.level(),
                .swirl = p.swirl(),
                .coarsest = static_cast<int>(k.effects[EffectOption::VorticityCoarsest])});
}

using ConfineView = ColumnView<columns(Column::Position, Column::Velocity, Column::Neighbours, Column::Normal,
                                       Column::VelocityNext),
                               columns(Column::Velocity)>;

void confine(FluidState& state, ConfineView p) {
  const auto& k = state.parameters;
  run_pair_loop("confinement", state, p,
                Confine{.curl = p.normal(),
                        .smooth = p.velocity_next(),
                        .velocity = p.velocity(),
                        .kick = k.dt * k.effects[EffectKind::Vorticity],
                        .from = k.effects[EffectOption::VorticityFrom],
                        .most = k.effects[EffectOption::VorticityMost],
                        .widest = state.widest_support(EffectOption::VorticityCoarsest)});
}

}  // namespace

std::vector<Stage> vorticity_stages() {
  return {stage_of<find_curl>({.name = "vorticity", .phase = Phase::SubstepEnd, .loop = SharedTerm::Curl}),
          stage_of<smooth_curl>({.name = "smooth curl", .phase = Phase::SubstepEnd}),
          stage_of<show_swirl>({.name = "swirl", .phase = Phase::SubstepEnd, .called_for = if_seen}),
          stage_of<confine>({.name = "confinement", .phase = Phase::SubstepEnd})};
}

}  // namespace sim::SIM_BACKEND
