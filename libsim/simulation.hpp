#pragma once
/// The fluid's interface for programs: one scene, one method, one back end.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libsim/exec/backend.hpp"
#include "libsim/exec/launch_time.hpp"
#include "libsim/impulse/momentum_account.hpp"
#include "libsim/methods/method.hpp"
#include "libsim/methods/preset.hpp"
#include "libsim/methods/solver_numbers.hpp"
#include "libsim/particles/divergence.hpp"
#include "libsim/particles/particle_state.hpp"
#include "libsim/ptpe/tolerance_switch.hpp"
#include "libsim/saliency/looks.hpp"
#include "libsim/scene/scene.hpp"
#include "stats/ptpe/ptpe.hpp"

namespace sim {

/// Target levels for tests, which replace the target levels of the method: one level inside a sphere, another
/// outside.
struct TargetRegion {
  Vec3d centre_m{};
  double radius_m = 0;
  int inside = 0;   ///< level 0 .. 3, limited to SimulationOptions::levels - 1
  int outside = 0;  ///< level, with the same limits
};

/// Options of temporal acceleration (ViP-Fluid, Algorithm 3), such as the source of tau. Methods without
/// temporal acceleration ignore them, unless `always` is set.
struct TemporalOptions {
  /// A constant tau = mu - a exp(b delta) (Eq. 11), frames/s. If neither fixed_tau nor fixed_rate is set, tau
  /// follows from the times passed to Simulation::frame_time.
  std::optional<double> fixed_tau;
  std::optional<FrameRate> fixed_rate;  ///< constant mean mu and standard deviation delta of the frame rate,
                                        ///< from which tau follows
  /// gives the tolerance tau and the lowest probability beta that a particle is solved, ViP-Fluid Eq. 11
  stats::PtpeModel model;
  std::uint32_t seed = 1;  ///< for the random choice of active particles
  bool always = false;  ///< accelerate methods without temporal acceleration too, for tests and comparisons
};

/// True if every particle is solved in every frame, whatever the frame times.
inline bool stays_off(const TemporalOptions& options) {
  return ToleranceSwitch(options.model, options.fixed_tau, options.fixed_rate).stays_off();
}

struct SimulationOptions : SolverNumbers {
  MethodKind method = MethodKind::HiRes;
  std::int64_t n_star = 32 * 1024;  ///< n_*: number of particles if all had the coarsest level, 3
  Backend backend = Backend::Cpu;
  Readings readings = readings_of(Preset::Tuned);
  /// Store the features from which saliency is computed (ParticleSaliency's members other than s and target)
  /// for read_saliency; methods without saliency have none to store.
  bool saliency_parts = false;
  std::optional<TargetRegion> forced_targets;  ///< for tests of methods that split and merge
  /// if particles split and merge: their maximum number, at least the number at the start; 0 = 8 n_star, the
  /// number if all have the finest level
  std::int64_t particle_capacity = 0;
  /// N, 1 .. 4: methods that split and merge use levels 0 .. N - 1. With N = 1 no particles merge, and only
  /// particles of `start` that are coarser than level 0 split. If `start` has no such particles, saliency is
  /// measured only for outputs and temporal acceleration.
  int levels = most_levels;
  TemporalOptions temporal;
  /// Start from these particles and skip filling and settling. Levels 0 .. 3 may be mixed, whatever the
  /// method; if particles split and merge, ids must be unique and below the capacity (particle_capacity).
  std::optional<std::vector<ParticleState>> start;
  /// Number of the frame that `start` shows, >= 0; nozzles and moving obstacles continue from this frame.
  int start_frame = 0;
  /// For starts in the middle of a run: maximum number of density projections that move the particles of
  /// `start` until the mass-weighted mean of max(rho / rho_0 - 1, 0) is below 0.2 %. Velocities do not
  /// change. The velocity grid of temporal acceleration, which moves the particles that a frame does not
  /// solve, is then built from the start as well. 0 = use the start unchanged.
  int start_projections = 0;
  /// Resume from a file that Simulation::save_state wrote in a run with the same scene and options. The run
  /// then continues bit for bit like the saved run. Excludes `start`; start_frame comes from the file.
  std::filesystem::path resume_from;
  /// Folder that caches settled states between runs (default_cache_folder()); empty = settle every time.
  std::filesystem::path cache;
  bool wall_impulse = false;                   ///< record Simulation::momentum(); costs extra passes
  std::vector<Gauge> gauges;                   ///< gauges on the walls; if not empty, implies wall_impulse
  std::vector<ObstacleGauge> obstacle_gauges;  ///< gauges on obstacles; if not empty, implies wall_impulse
  bool keeps_momentum() const { return wall_impulse || !gauges.empty() || !obstacle_gauges.empty(); }
  bool time_parts = false;  ///< measure Simulation::part_times(); waits for the device between parts
  /// Called after each settling frame with (done, total).
  std::function<void(int, int)> settling;
};

/// Counts since the simulation was made: how often each of the solver's safety rules (guards) intervened.
struct GuardCounts {
  /// times that the speed of a particle or a free body was limited; a particle counts up to twice per
  /// substep, and up to three times with the effect viscosity
  std::uint64_t speed_limited = 0;
  /// neighbours closer than 1e-5 of the pair's support, counted in each density pass; a pair of solved
  /// particles counts twice
  std::uint64_t coincident_pairs = 0;
  /// particle-substeps in which a particle was quarantined: its position or velocity was NaN or infinite, or
  /// it was far outside the tank
  std::uint64_t not_finite = 0;
  /// neighbours left out of a list because the memory for lists was full
  std::uint64_t neighbours_dropped = 0;
  std::uint64_t wall_projected = 0;  ///< position corrections of particles by walls and obstacles
  /// layers that a nozzle did not pour, because the tank's corners, from which nozzles take water, had too
  /// few particles, or because the particle capacity was reached
  std::uint64_t nozzle_waited = 0;
  std::uint64_t saliency_not_finite = 0;  ///< particle-turns whose saliency was NaN or infinite; s is then 0
  std::uint64_t gaze_lost = 0;            ///< eye-frames without a valid gaze (libsim/saliency/looks.hpp)
};

/// Splits and merges since the simulation was made. A turn is one update of the levels; particle-turns count
/// the affected particles of each turn. particles = particles at the start + born - merges +
/// FrameReport::particles_in - particles_out.
struct LevelEvents {
  std::uint64_t splits = 0;
  std::uint64_t born = 0;            ///< particles added by splits: a split into 2^k children adds 2^k - 1
  std::uint64_t merges = 0;          ///< merges; each removes one particle
  std::uint64_t split_deferred = 0;  ///< particle-turns in which Readings::split_share delayed a split
  /// particle-turns in which no children fitted between the walls and obstacles
  std::uint64_t split_at_wall = 0;
  /// particle-turns (particles times updates of the levels) in which a split exceeded the capacity
  std::uint64_t split_no_room = 0;
  /// particle-turns in which a particle found no partner, and at least one candidate was refused because the
  /// merged particle would overlap a coarser particle or an obstacle
  std::uint64_t merge_overlap = 0;
  /// particle-turns in which a neighbour of a finer level or target prevented a merge
  std::uint64_t merge_step = 0;
  double energy_lost_j = 0;  ///< kinetic energy lost in merges
};

/// Inputs and results of temporal acceleration in one frame; Eq. 11 is ViP-Fluid's.
struct TemporalReport {
  std::optional<double> tau;      ///< frames/s, Eq. 11; none = no frame time known yet
  std::optional<FrameRate> rate;  ///< mu and delta of tau; none = tau was given, or no frame time yet
  double beta = 1;                ///< lowest probability that a particle is solved
  std::int64_t active = 0;        ///< number of solved particles
};

/// Particle counts, temporal acceleration, and interventions of the safety rules (guards) in a frame.
/// Recording them costs almost no time.
struct FrameAccount {
  std::vector<std::int64_t> particles_by_level;  ///< one count per radius of Simulation::radii_m
  std::optional<TemporalReport> temporal;        ///< none = no temporal acceleration, or no frame yet
  std::optional<GuardCounts> guards;             ///< of this frame only; none = no frame yet

  std::int64_t particles() const {
    return std::accumulate(particles_by_level.begin(), particles_by_level.end(), std::int64_t{0});
  }
};

/// Number of substeps of a frame.
struct SubstepCount {
  int taken = 0;   ///< 0 = no frame yet
  int wished = 0;  ///< number that speeds and forces require; larger than `taken` if the limit applied
};

/// Times of the last frame's parts, ms, divided as in Table 2 of ViP-Fluid, whose equations the comments
/// name.
struct PartTimes {
  double saliency_ms = 0;  ///< Eq. 1-9
  double levels_ms = 0;    ///< grading, splitting, merging
  /// choice of the particles to solve, Eq. 12-14, and the velocity grid, which moves the others
  double activation_ms = 0;
  double solve_ms = 0;  ///< all other passes
};

/// A pass of the compiled schedule.
struct StageTime {
  std::string name, phase;  ///< names as printed by --explain
  /// The effect that requires the pass; no_effect if the pass is needed without effects. If two effects share
  /// the pass: the first of them.
  EffectKind effect = no_effect;
  double ms = 0;  ///< all its runs in the last frame; 0 unless Simulation::time_passes is on
};

/// Result of SimulationOptions::start_projections.
struct RelaxedStart {
  int projections = 0;
  double compression = 0;  ///< remaining mass-weighted mean of max(rho / rho_0 - 1, 0)
};

/// Heat divided by the water's specific heat, in m_* K with m_* the mass of a particle of level 0, relative
/// to water at the reference temperature; all zero unless the scene lists the effect heat. poured: brought in
/// by nozzles; taken: removed with water that nozzles take from the tank; drained: lost through outlets. held
/// + taken + drained - poured - from_walls is constant.
struct HeatReport {
  double held = 0;                                            ///< heat of the water now
  double poured = 0, taken = 0, drained = 0, from_walls = 0;  ///< since the simulation was made
};

/// Diffuse particles of the effect foam since the simulation was made: emitted = spray + foam + bubbles +
/// dissolved + dropped + left.
struct FoamReport {
  std::uint64_t emitted = 0;                       ///< requested by the water's motion
  std::uint64_t dissolved = 0;                     ///< reached the end of their lifetime on the water
  std::uint64_t dropped = 0;                       ///< could not be stored because the pool was full
  std::uint64_t left = 0;                          ///< left through an outlet, or became non-finite
  std::uint64_t spray = 0, foam = 0, bubbles = 0;  ///< present now: in the air, on the surface, under water
};

/// State of the fluid after a frame.
struct FrameReport {
  int frame = 0;          ///< as Simulation::frame()
  SubstepCount substeps;  ///< of the last frame
  double time_s = 0;
  std::int64_t particles = 0;
  std::vector<std::int64_t> particles_by_level;  ///< up to the coarsest level present
  std::int64_t mass_units = 0;                   ///< total mass in m_*: the sum of 2^level, exact
  LevelEvents levels;
  double jump_share = 0;          ///< share of pairs within h whose levels differ by more than one
  double density_error_mean = 0;  ///< mean of max(rho / rho_0 - 1, 0)
  double density_max = 0;         ///< max of rho / rho_0
  double neighbours_mean = 0;     ///< mean number of neighbours within h, without the particle itself
  double listed_mean = 0;         ///< mean length of the neighbour lists, which reach beyond h
  double speed_max_m_s = 0;
  /// mass poured by nozzles since the simulation was made, in m_*, the mass of a level-0 particle
  std::int64_t poured = 0;
  std::int64_t particles_in = 0;  ///< particles made by nozzles
  /// Particles taken by nozzles or released through outlets. If all particles have one level, nozzles take as
  /// many particles as they make.
  std::int64_t particles_out = 0;
  std::int64_t drained = 0;  ///< mass that left through outlets, in m_*
  /// Mass that was taken for nozzles and is not yet poured, in m_*; mass_units + reservoir + drained is
  /// constant.
  std::int64_t reservoir = 0;
  HeatReport heat;
  GuardCounts guards;
  TemporalReport temporal;
  SeenReport seen;  ///< the last picture that look() passed to saliency
  RelaxedStart start;
  FoamReport foam;
};

/// Numbers that may change while the fluid runs.
struct LiveNumbers {
  double alpha = 0;    ///< ViP-Fluid Eq. 1: weight of the temporal feature, 0 .. 1
  int iterations = 0;  ///< constraint projections per substep, 1 .. most_iterations

  static constexpr int most_iterations = SolverNumbers::most_iterations;
};

class Simulation {
 public:
  virtual ~Simulation() = default;

  /// Sets the eyes and the last pictures they saw. They apply from the next frame until the next call.
  /// Methods without gaze ignore them. Before the first call, methods with gaze use the scene's camera and a
  /// gaze along its axis. Returns false, and changes nothing, if a picture lies in GL buffers that this back
  /// end cannot read (EyeLook::shared, on a CPU or with a context of another device): then read the picture
  /// back and call again. Until the next copy_to_gl, the simulation owns the shared buffers of this call and
  /// of copy_to_gl: GL must not read or draw them. If the next frame does not update levels, only gazes and
  /// cameras are used, and the call returns true. base::Error: no eye or more than two, a camera that is not
  /// finite, a visual scale that is not positive, a picture with incomplete arrays or without a perspective
  /// camera.
  virtual bool look(const Looks& looks) = 0;
  /// True if this run computes saliency from the picture passed to look(); if false, the caller need not read
  /// the picture back from the renderer.
  virtual bool follows_picture() const = 0;
  /// True if every frame must be drawn, as a viewer sees it: the run follows pictures, or a picture depends
  /// on those before it. The latter holds with levels, whose ellipsoids change in steps between turns
  /// (libsim/surface).
  bool needs_every_picture() const { return follows_picture() || radii_m().size() > 1; }
  /// Number of frames since the water's settling ended (frame 0), including SimulationOptions::start_frame.
  virtual int frame() const = 0;
  /// Simulated time since frame 0, s.
  virtual double time_s() const { return 0; }
  /// Advances by one frame.
  virtual void step_frame() = 0;
  /// Replaces SimulationOptions::forced_targets from the next frame on; base::Error if the run was made
  /// without forced targets.
  virtual void force_targets(const TargetRegion&) {}
  virtual LiveNumbers live_numbers() const { return {}; }
  /// Changes these numbers from the next frame on; alpha takes effect at the next level update. base::Error
  /// if one is out of range.
  virtual void change(const LiveNumbers&) {}
  /// Replaces the list of effects from the next frame on. The schedule (the list of a frame's passes) is
  /// compiled anew. Particles, velocities, levels and guard counts stay. A new effect starts as in a new run:
  /// temperatures from the scene's boxes, foam without particles. Effects that stay keep their state, but
  /// foam begins anew if its most_particles changed. The number of substeps follows the new effects. From
  /// then on the run is bit for bit equal to a run without the removed effects that starts from this state.
  /// Columns of removed effects are freed. base::Error, with nothing changed: check_effects refuses the list,
  /// it needs more substeps than the options or the program allow, or the foam particles are so small that a
  /// frame could create more than an int can count. base::Error, after which the simulation cannot be used:
  /// the device is out of memory.
  virtual void set_effects(const std::vector<Effect>&) {}
  /// Sets the duration of the last whole frame, ms, from which the frame rate tolerance tau of temporal
  /// acceleration follows (ViP-Fluid Eq. 11). Methods without temporal acceleration ignore it.
  virtual void frame_time(double) {}
  /// Account of the last frame; before the first frame, the particle counts of the start.
  virtual const FrameAccount& account() const = 0;
  /// Changes of the water's momentum in the last frame, and the impulses on walls and gauges. All zero
  /// without SimulationOptions::wall_impulse or gauges.
  virtual MomentumAccount momentum() const { return {}; }
  /// Substeps of the last frame.
  virtual SubstepCount substeps() const { return {}; }
  /// The first sign of divergence since the simulation was made; none in a sound run. Costs almost no time.
  virtual std::optional<Divergence> divergence() const { return {}; }
  /// Sets position and velocity of existing particles, by id, so that tests can disturb the water. Levels do
  /// not change. base::Error for an unknown id.
  virtual void put(const std::vector<ParticleState>&) {}
  /// Measures the present state on a copy of the particles. This is slow, and not part of step_frame.
  virtual FrameReport report() = 0;
  virtual std::int64_t particle_count() const = 0;
  /// Maximum number of particles in the whole run; a buffer for this many never needs to grow.
  virtual std::int64_t particle_capacity() const { return particle_count(); }
  /// Rest spacing d = 2 r of the finest particles that the method may have, m.
  virtual double spacing_m() const = 0;
  /// Every radius that read_particles may return, m, finest first.
  virtual std::vector<float> radii_m() const = 0;
  /// Positions and radii in the solver's order, copied to the host.
  virtual void read_particles(std::vector<RenderParticle>& out) const = 0;
  /// Saliency from which the present target levels were computed, in the order of read_particles. Children
  /// copy their parent's value; a merged particle keeps the value of one of its parents. Without
  /// SimulationOptions::saliency_parts the fields other than s and target are 0. Empty at frame 0, and in
  /// runs that compute neither saliency nor gaze targets.
  virtual void read_saliency(std::vector<ParticleSaliency>& out) const = 0;
  /// Saliency (ViP-Fluid Eq. 1-9) of the present state for the given eyes, for any method, as if this were
  /// the first frame. For masks and figures, not part of step_frame. Sorts the particles; `out` is in the
  /// order of a later read_particles. base::Error if a picture lies in GL buffers that this back end cannot
  /// read.
  virtual void measure_saliency(const Looks& looks, std::vector<ParticleSaliency>& out) = 0;
  /// ParticleSaliency::s and target by the rule of methods whose levels follow the gaze alone, in the order
  /// of read_particles; the other fields are 0. Pictures are not read.
  virtual void measure_gaze_targets(const Looks& looks, std::vector<ParticleSaliency>& out) = 0;
  /// Ids in the order of read_particles.
  virtual std::vector<int> read_ids() const = 0;
  /// One value per particle in the order of read_particles.
  virtual void read_field(ParticleField field, std::vector<float>& out) const = 0;
  /// The state of every particle, ordered by id.
  virtual std::vector<ParticleState> read_state() const = 0;
  /// Writes the whole state between two frames, for SimulationOptions::resume_from, to a temporary file that
  /// is then renamed. The state includes the last look() and the frame times from which tau follows
  /// (frame_time). It excludes part_times() and momentum(). base::Error if the file cannot be written.
  virtual void save_state(const std::filesystem::path& path) = 0;
  /// Copies positions and radii into a GL buffer of this thread's context, on the device. Returns false if
  /// this back end cannot write the buffer (a CPU, or a context of another device) or the buffer is too
  /// small: then use read_particles and upload the result.
  virtual bool copy_to_gl(const GlBufferRef& buffer) = 0;
  /// The particles as ellipsoids (libsim/surface): smoothed places and radii, and shapes, copied to the host;
  /// in the order of read_particles, then those that merged into others and fade out. No shapes: this
  /// simulation has none, and `out` is that of read_particles.
  virtual void read_surface(std::vector<RenderParticle>& out, std::vector<RenderShape>& shapes) {
    read_particles(out);
    shapes.clear();
  }
  /// Writes what read_surface returns into two GL buffers of this thread's context, on the device. Each
  /// buffer needs room for particle_capacity() elements. Returns the number of particles written. Returns
  /// nothing where copy_to_gl would return false: then use read_surface and upload the result.
  virtual std::optional<std::int64_t> copy_surface_to_gl(const GlBufferRef&, const GlBufferRef&) {
    return {};
  }
  /// The scene's obstacles between two frames, in the scene's order, copied to the host.
  virtual std::vector<BodyMotion> read_obstacles() const { return {}; }
  /// Maximum number of foam particles; 0 without the effect foam.
  virtual std::int64_t foam_capacity() const { return 0; }
  /// Positions and radii of the foam particles, copied to the host.
  virtual void read_foam(std::vector<RenderParticle>& out) const { out.clear(); }
  /// Like copy_to_gl, with foam_capacity() entries; radius 0 marks an unused entry. Also returns false
  /// without foam.
  virtual bool copy_foam_to_gl(const GlBufferRef&) { return false; }
  /// Times of the last frame's parts; all zero without SimulationOptions::time_parts.
  virtual PartTimes part_times() const = 0;
  /// The passes of a frame, in the schedule's order.
  virtual std::vector<StageTime> passes() const { return {}; }
  /// Switches the timer of each pass on or off. While on, a frame waits for the device after each pass.
  virtual void time_passes(bool) {}
  /// Switches timing of every launch of this back end on or off, and discards earlier measurements. Costs a
  /// few microseconds per launch while on.
  virtual void profile_launches(bool) {}
  /// Total time of the launches with each label since profile_launches(true), longest first.
  virtual std::vector<LaunchTime> launch_times() const { return {}; }
  /// Waits for all launched work.
  virtual void synchronize() = 0;
  /// Bytes of memory for particles, nozzles, outlets, saliency, temporal acceleration and foam.
  virtual std::size_t particle_bytes() const = 0;
  /// The run as text: method, back end, substeps, particles and memory; obstacles and effects if there are
  /// any; the schedule, with the reason for each pass and for each stage that is left out; the columns.
  virtual std::string explain() const = 0;
};

/// Minimum number of substeps per frame that the scene or the options, and the effects that act on the
/// scene's water, require. base::Error if the options allow fewer substeps than an effect needs, or if an
/// effect needs more than the program allows.
int least_substeps(const Scene& scene, const SimulationOptions& options);

/// Fills the scene with water, lets it settle, and returns the simulation at frame 0; or starts from
/// SimulationOptions::start or resume_from. Errors are base::Error.
std::unique_ptr<Simulation> make_simulation(const Scene& scene, const SimulationOptions& options);

}  // namespace sim
