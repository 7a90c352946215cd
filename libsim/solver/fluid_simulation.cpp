#include "libsim/solver/fluid_simulation.hpp"

#include "libsim/exec/gl_sharing.hpp"
#include "libsim/ptpe/tolerance_switch.hpp"
#include "libsim/scene/extent.hpp"
#include "libsim/scene/fill.hpp"
#include "libsim/solver/account_keeper.hpp"
#include "libsim/solver/kept_state.hpp"
#include "libsim/solver/readout.hpp"
#include "libsim/solver/state_file.hpp"
#include "libsim/surface/ellipsoids.hpp"
#include "stats/base/error.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Maximum mean compression, max(rho / rho_0 - 1, 0), of water that needs no pre-stabilisation. Moving water
/// has a mean compression of 0.1 to 0.3 %.
constexpr double calm_compression = 0.005;

/// Lets `write` fill GL buffers with 16 bytes for each of n particles; false if they cannot be shared.
template <class Write>
bool share(GlSharing& by, const std::vector<GlBufferRef>& buffers, int n, Write write) {
  bool shared = true;
  for (const GlBufferRef& one : buffers)
    shared = shared && one.bytes >= static_cast<std::size_t>(n) * sizeof(Vec4);
  shared = shared && by.accept(buffers);
  if (shared) write(by.map());
  by.unmap();
  return shared;
}

class FluidSimulation final : public Simulation {
 public:
  FluidSimulation(const Scene& scene, const SimulationOptions& options)
      : scene_(scene),
        options_(options),
        resolution_(resolution_of(scene, options.method, options.n_star)),
        tolerance_(options.temporal.model, options.temporal.fixed_tau, options.temporal.fixed_rate),
        frame_(options.start_frame),
        // A start at frame 0 may be compressed, and so begins with a pre-stabilisation; a start in the middle
        // of a run does not.
        compression_(options.start_frame == 0 ? 1 : 0) {
    check_levels(options.levels);
    check_effects(scene.effects);
    if (options.resume_from.empty()) begin_with(levels_at_start(scene, options));
    if (options.time_parts) state_.clock.switch_on();
    state_.saliency.readings = options.readings;
    state_.saliency.levels = options.levels;
    if (traits_of(options.method).target != TargetSource::None)
      state_.saliency.input.look_by_default(make_view(scene.view, 1280, 720));
    state_.levels.rules = LevelRules(options.readings, options.levels);
    if (options.forced_targets) force_targets(*options.forced_targets);
    state_.activation.rules = ActivationRules(options.readings);
    state_.activation.seed = options.temporal.seed;
    state_.guards.resize(1);
    state_.guards.zero();
    state_.refuge = {static_cast<float>(scene.tank_size_m[0] / 2), static_cast<float>(scene.tank_size_m[1]),
                     static_cast<float>(scene.tank_size_m[2] / 2)};
    if (!options.resume_from.empty()) {
      resume(read_state_file(options.resume_from, run_key(scene, options)));
    } else if (options.start) {
      open(*options.start);
      if (options.start_projections > 0) relaxed_ = prepare_start(state_, options.start_projections);
    } else {
      const double edge = static_cast<double>(state_.parameters.coarse_edge) * 2 * resolution_.spacing_m;
      check_extent(scene, options.method, options.n_star, edge);
      const auto start = filled(scene, options, resolution_.level);
      open(start);
      const int substeps = state_.parameters.substeps;
      set_substeps(substep_rule(acting_scene(scene_, levels_.first), options_, resolution_, 0,
                                start_acceleration(scene_, start))
                       .next());
      settle(state_, scene_, options_);
      set_substeps(substeps);
      state_.one_level = is_of_one_level();
    }
    if (options.resume_from.empty()) warm_up(state_, scene_);
    if (options.keeps_momentum()) state_.impulse.begin(options.gauges, scene.room_m(), state_.finest_support);
    begin_patches(state_, options.obstacle_gauges);
  }

  bool look(const Looks& looks) override {
    // GL has finished drawing: mapping the particle buffers already here saves a switch to CUDA.
    gl_.map_again();
    if (!looks_) return true;
    SaliencyInput& input = state_.saliency.input;
    return input.look(looks, follows_picture() && state_.levels.turns.would_be(state_.saliency.readings,
                                                                               input.turned_deg(looks)));
  }

  bool follows_picture() const override {
    return traits_of(options_.method).target == TargetSource::Saliency && looks_;
  }
  int frame() const override { return frame_; }
  double time_s() const override { return frame_ * frame_dt(); }

  void step_frame() override {
    state_.jets.frame = frame_;
    state_.obstacles.frame_begin_s = time_s();
    state_.activation.beta = static_cast<float>(tolerance_.beta());
    state_.activation.frame = static_cast<std::uint32_t>(frame_);
    substeps_taken_ = {substeps_.next(), substeps_.wished()};
    set_substeps(substeps_taken_.taken);
    if (looks_) state_.saliency.begin_frame(state_.levels.turns, frame_dt());
    state_.compressed = compression_.value() > calm_compression;
    run_frame(schedule_, state_);
    momentum_ = state_.impulse.end_frame(state_.parameters.rest_density, state_.parameters.dt);
    count_obstacles(state_, momentum_);
    const FrameTally tally = keeper_.take(state_, went_by(), frame_ + 1);
    substeps_.frame_ended(static_cast<double>(tally.extremes.fastest()));
    compression_.frame_ended(tally.extremes.compression());
    // Growing the lists moves them: their contents are lost.
    if (state_.neighbours.grow(tally.lists)) state_.lists_hold = false;
    state_.levels.turns.end_frame();
    ++frame_;
  }

  const FrameAccount& account() const override { return keeper_.account(); }
  MomentumAccount momentum() const override { return momentum_; }
  SubstepCount substeps() const override { return substeps_taken_; }
  std::optional<Divergence> divergence() const override { return keeper_.divergence(); }

  void put(const std::vector<ParticleState>& particles) override {
    put_again(state_, particles);
    state_.lists_hold = false;
  }

  void force_targets(const TargetRegion& region) override {
    if (!options_.forced_targets)
      throw base::Error("forced targets", "were not set when the run was made",
                        "set SimulationOptions::forced_targets");
    state_.levels.forced = sphere_of(region);
  }

  LiveNumbers live_numbers() const override {
    return {state_.saliency.readings.alpha, state_.parameters.iterations};
  }

  void change(const LiveNumbers& to) override {
    check_live(to);
    state_.saliency.readings.alpha = to.alpha;
    state_.parameters.iterations = to.iterations;
  }

  void set_effects(const std::vector<Effect>& effects) override {
    Scene scene = scene_;
    scene.effects = effects;
    check_effects(effects);
    const Scene acting = acting_scene(scene, levels_.first);
    const SolverParameters numbers = solver_parameters(acting, options_);
    check_foam(state_, numbers.effects, scene, frame_dt());
    Demand demand = demand_of(scene, options_, numbers, levels_);
    demand.rests_by_drift = state_.one_level_rests_by_drift;  // keeps the column Drift, or its absence
    Schedule schedule = compile_schedule(demand);
    // From here on only an allocation can fail.
    scene_ = std::move(scene);
    schedule_ = std::move(schedule);
    state_.parameters.effects = numbers.effects;
    state_.parameters.most_speed = most_speed(fall_speed_, acting, resolution_, numbers);
    set_substeps(numbers.substeps);
    substeps_.take_bounds(substep_rule(acting, options_, resolution_, 0, 0));
    exchange_effects(state_, scene_, schedule_.columns);
    time_passes(timing_passes_);
  }

  std::vector<StageTime> passes() const override { return stage_times(schedule_, state_.pass_clock); }
  void time_passes(bool on) override {
    timing_passes_ = on;
    state_.pass_clock.measure(on ? schedule_.passes : 0);
  }

  void frame_time(double ms) override { tolerance_.frame_time(ms); }

  FrameReport report() override {
    FrameReport out = report_of(state_);
    out.frame = frame_;
    out.substeps = substeps_taken_;
    out.time_s = time_s();
    if (changes_levels_) out.levels = events_of(state_.levels.counts.to_host()[0]);
    out.temporal = account().temporal.value_or(TemporalReport{{}, {}, 1, particle_count()});
    out.start = relaxed_;
    return out;
  }

  PartTimes part_times() const override { return times_of(state_.clock); }
  std::int64_t particle_count() const override { return state_.particles.size(); }
  std::int64_t particle_capacity() const override { return state_.particles.capacity(); }
  double spacing_m() const override { return resolution_.spacing_m; }
  void profile_launches(bool on) override { SIM_BACKEND::profile_launches(on); }
  std::vector<LaunchTime> launch_times() const override { return SIM_BACKEND::launch_times(); }
  void synchronize() override { SIM_BACKEND::synchronize(); }
  std::size_t particle_bytes() const override { return bytes_of(state_); }

  void read_particles(std::vector<RenderParticle>& out) const override {
    render_particles_of(state_.particles, out);
  }
  std::vector<BodyMotion> read_obstacles() const override { return motions_of(state_, time_s()); }
  std::int64_t foam_capacity() const override { return state_.foam.capacity(); }
  void read_foam(std::vector<RenderParticle>& out) const override { render_foam_of(state_, out); }
  bool copy_foam_to_gl(const GlBufferRef& buffer) override {
    const auto pack = [this](const auto& memory) { pack_foam(state_, static_cast<Vec4*>(memory[0])); };
    return state_.foam.capacity() > 0 && share(foam_gl_, {buffer}, state_.foam.capacity(), pack);
  }

  std::vector<float> radii_m() const override { return radii_of(state_.supports, levels_); }

  void read_saliency(std::vector<ParticleSaliency>& out) const override {
    out.clear();
    if (frame_ == 0 || !state_.particles.has(Column::Saliency)) return;
    const auto& p = state_.particles.all();
    pack_saliency(p.saliency.to_host(), p.target.to_host(), p.saliency_parts.to_host(), out);
  }

  void read_field(ParticleField field, std::vector<float>& out) const override {
    out = field_of(state_.particles, field);
  }

  void measure_saliency(const Looks& looks, std::vector<ParticleSaliency>& out) override {
    SaliencyState observer = observer_of(options_.readings, options_.levels);
    if (!observer.input.look(looks)) {
      throw base::Error("measure_saliency", "a picture lies in GL buffers that this back end cannot read",
                        "copy the picture to the host, and give the copy");
    }
    Array<float> s;
    Array<std::uint8_t> target;
    Array<SaliencyParts> parts;
    SIM_BACKEND::measure_saliency(state_, observer, s, target, parts);
    pack_saliency(s.to_host(), target.to_host(), parts.to_host(), out);
  }

  void measure_gaze_targets(const Looks& looks, std::vector<ParticleSaliency>& out) override {
    SaliencyState observer = observer_of(options_.readings, options_.levels);
    observer.input.look(looks, false);
    Array<float> s;
    Array<std::uint8_t> target;
    SIM_BACKEND::measure_gaze(state_, observer, s, target);
    pack_saliency(s.to_host(), target.to_host(), {}, out);
  }

  std::vector<int> read_ids() const override { return state_.particles.all().id.to_host(); }
  std::vector<ParticleState> read_state() const override { return states_of(state_.particles); }
  void save_state(const std::filesystem::path& path) override {
    StateWriter out;
    int n = state_.particles.size(), capacity = state_.particles.capacity();
    out(n, capacity, levels_.first, levels_.second);
    keep(out);
    write_state_file(path, run_key(scene_, options_), out.bytes());
  }

  bool copy_to_gl(const GlBufferRef& buffer) override {
    const auto pack = [this](auto& to) { pack_for_drawing(state_.particles, static_cast<Vec4*>(to[0])); };
    const bool shared = share(gl_, {buffer}, state_.particles.size(), pack);
    state_.saliency.input.give_back();
    return shared;
  }

  void read_surface(std::vector<RenderParticle>& out, std::vector<RenderShape>& shapes) override {
    surface_.read(surface_input(), out, shapes);
  }

  std::optional<std::int64_t> copy_surface_to_gl(const GlBufferRef& particles,
                                                 const GlBufferRef& shapes) override {
    std::optional<std::int64_t> written;
    share(gl_, {particles, shapes}, state_.particles.capacity(), [&](const auto& memory) {
      written = surface_.compute(surface_input(), static_cast<Vec4*>(memory[0]),
                                 static_cast<RenderShape*>(memory[1]));
    });
    state_.saliency.input.give_back();
    return written;
  }

  std::string explain() const override {
    const auto& k = state_.parameters;
    return "method " + method_name(options_.method) + " on " + backend_name(options_.backend) + ": " +
           std::to_string(k.substeps) + " substeps x " + std::to_string(k.iterations) + " iterations, " +
           std::to_string(particle_count()) + " particles of " + levels_in_words() + ", " +
           std::to_string(particle_bytes()) + " bytes\n" + obstacles_in_words(scene_.obstacles) +
           effects_in_words(scene_.effects, acting_scene(scene_, levels_.first), options_) +
           schedule_.explanation;
  }

 private:
  SurfaceParticles surface_input() const {
    return surface_particles_of(state_, scene_.lid, frame_, changes_levels_);
  }
  bool is_of_one_level() const { return !changes_levels_ && levels_.first == levels_.second; }

  /// Report of temporal acceleration (ViP-Fluid Eq. 11) in the frame that ends; none in a run without it.
  std::optional<TemporalReport> went_by() const {
    if (!traits_of(options_.method).temporal && !options_.temporal.always) return {};
    return TemporalReport{tolerance_.tau(), tolerance_.rate(), tolerance_.beta(), 0};
  }

  std::string levels_in_words() const {
    if (changes_levels_) return "levels 0 to " + std::to_string(options_.levels - 1);
    return state_.one_level ? "level " + std::to_string(resolution_.level) : "mixed levels";
  }

  /// Sets the solver numbers and the schedule for particles of these levels, finest and coarsest.
  void begin_with(std::pair<int, int> levels) {
    levels_ = levels;
    state_.parameters = solver_parameters(acting_scene(scene_, levels.first), options_);
    const Demand demand = demand_of(scene_, options_, state_.parameters, levels);
    changes_levels_ = demand.levels;
    state_.one_level_rests_by_drift = demand.rests_by_drift;
    looks_ = demand.saliency || demand.gaze_targets;
    schedule_ = compile_schedule(demand);
  }

  void open(const std::vector<ParticleState>& start) {
    const int capacity = capacity_for(start.size(), options_, changes_levels_);
    check_start(start, capacity, changes_levels_);
    lay_out(static_cast<int>(start.size()), capacity);
    keeper_.begin(start, levels_.first, levels_.second);
    fall_speed_ = fall_speed(scene_, start);
    const Scene acting = acting_scene(scene_, levels_.first);
    state_.parameters.most_speed = most_speed(fall_speed_, acting, resolution_, state_.parameters);
    substeps_ = substep_rule(acting, options_, resolution_, start_speed(scene_, start),
                             start_acceleration(scene_, start));
    put_in(state_, start);
    if (changes_levels_) state_.levels.begin(NewLevelsView(state_.particles));
  }

  /// Allocates columns for n particles; sets up the supports of levels, walls, obstacles, jets and foam.
  void lay_out(int n, int capacity) {
    state_.particles.allocate(schedule_.columns, n, capacity);
    state_.one_level = is_of_one_level();
    state_.supports = level_supports(2 * resolution_.finest_spacing_m);
    state_.finest_support = state_.supports.h[0];
    state_.lightest_support = state_.supports.h[levels_.first];
    state_.domain = {{0, 0, 0},
                     {static_cast<float>(scene_.tank_size_m[0]), static_cast<float>(scene_.tank_size_m[1]),
                      static_cast<float>(scene_.tank_size_m[2])}};
    state_.walls = walls_of(scene_, false);
    begin_obstacles(state_, scene_, levels_.second, time_s(), options_.keeps_momentum());
    begin_jets(state_, scene_, options_, resolution_, frame_);
    check_foam(state_, state_.parameters.effects, scene_, frame_dt());
    if (state_.parameters.effects[EffectKind::Foam] > 0) begin_foam(state_, scene_);
  }

  template <class Archive>
  void keep(Archive& archive) {
    archive(frame_, relaxed_, fall_speed_, substeps_, substeps_taken_, compression_, tolerance_, keeper_);
    keep_fluid(archive, state_);
    archive(surface_);
  }

  void resume(std::string_view body) {
    StateReader in(body);
    int n = 0, capacity = 0;
    std::pair<int, int> levels;
    in(n, capacity, levels.first, levels.second);
    if (n < 0 || capacity < n || levels.first < 0 || levels.second < levels.first ||
        levels.second >= most_levels)
      StateReader::fail("has no valid number of particles or levels");
    begin_with(levels);
    lay_out(n, capacity);
    keep(in);
    in.finish();
  }

  void set_substeps(int count) {
    state_.parameters.substeps = count;
    state_.parameters.dt = static_cast<float>(frame_dt() / count);
  }
  double frame_dt() const { return frame_dt_of(scene_, options_); }

  Scene scene_;
  SimulationOptions options_;
  Resolution resolution_;
  RelaxedStart relaxed_;
  double fall_speed_ = 0;  ///< fall_speed() of the start, m/s
  FluidState state_;
  Ellipsoids surface_;  ///< for pictures only
  Schedule schedule_;
  SubstepRule substeps_;
  SubstepCount substeps_taken_;
  MomentumAccount momentum_;
  bool timing_passes_ = false;
  ToleranceSwitch tolerance_;
  GlSharing gl_{GlSharing::Access::Overwrite}, foam_gl_{GlSharing::Access::Overwrite};
  int frame_;
  TwoFramesAgo<double> compression_;  ///< mean of max(rho / rho_0 - 1, 0)
  std::pair<int, int> levels_;        ///< finest and coarsest level that particles may have
  bool changes_levels_ = false;       ///< particles split and merge
  bool looks_ = false;                ///< a stage uses saliency or the gaze
  AccountKeeper keeper_;
};

}  // namespace

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const SimulationOptions& options) {
  return std::make_unique<FluidSimulation>(scene, options);
}

}  // namespace sim::SIM_BACKEND
