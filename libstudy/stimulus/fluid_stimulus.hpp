#pragma once
/// Fluids as implementations of study::Stimulus: baked pictures, baked particles or a running simulation.
///
/// All draw in the GL context that is current at the first draw() and hold GL objects of it afterwards:
/// destroy them before the display. A content step is one frame of the scene.

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libsim/bake/picture_ring.hpp"
#include "libsim/render/fluid_picture.hpp"
#include "libsim/render/fluid_renderer.hpp"
#include "libsim/render/temperature_scale.hpp"
#include "libsim/setting/solver_setting.hpp"
#include "libsim/simulation.hpp"
#include "libstudy/display/stimulus.hpp"
#include "libstudy/stimulus/framing.hpp"

namespace study {

/// Plays the pictures of a bake, decoded ahead. draw() uploads and copies one; a framebuffer of another size
/// gets the whole picture, scaled, between black bars.
class BakedPictures final : public Stimulus {
 public:
  explicit BakedPictures(std::unique_ptr<sim::BakeReader> bake);
  ~BakedPictures() override;

  std::string description() const override;
  std::int64_t length() const override { return bake_->header().frame_count; }
  /// Waits until pictures are decoded ahead; returns at once if the loop continues at start_step anyway.
  void start(std::int64_t start_step) override;
  FrameFacts prepare(std::int64_t step) override;
  void draw(const Canvas& canvas) override;
  /// How often a picture was not decoded in time since start().
  std::int64_t waits() const { return ring_.waits(); }

 private:
  std::unique_ptr<sim::BakeReader> bake_;
  sim::PictureRing ring_;
  const sim::BakePicture* picture_ = nullptr;
  unsigned texture_ = 0, source_ = 0;  ///< the picture, and the framebuffer it is copied from
};

/// Renders the particle frames of a bake with their foam. Paints temperatures over them if asked to and the
/// bake holds them.
class BakedParticles final : public Stimulus {
 public:
  explicit BakedParticles(std::unique_ptr<sim::BakeReader> bake, Viewing viewing = {},
                          const sim::RenderOptions& options = {}, bool paint_temperature = false);

  std::string description() const override;
  std::int64_t length() const override { return bake_->header().frame_count; }
  void start(std::int64_t) override {}
  FrameFacts prepare(std::int64_t step) override;
  void draw(const Canvas& canvas) override;

 private:
  std::unique_ptr<sim::BakeReader> bake_;
  sim::Scene scene_;
  Viewing viewing_;
  sim::RenderOptions options_;
  std::optional<sim::TemperatureScale> painted_;
  sim::BakeFrame frame_;
  std::unique_ptr<sim::FluidRenderer> renderer_;
  sim::ParticleBuffer particles_, foam_;
};

/// A simulation that advances one frame per content step and gets the picture that its viewer saw last.
class LiveFluid final : public Stimulus {
 public:
  /// Makes the simulation at frame 0; called again for each rewind.
  using MakeSimulation = std::function<std::unique_ptr<sim::Simulation>()>;

  /// paint_temperature: paints temperatures over the water if the scene has heat.
  LiveFluid(const sim::Scene& scene, double frame_dt_s, std::string description, MakeSimulation make,
            Viewing viewing = {}, const sim::RenderOptions& options = {}, bool paint_temperature = false);

  std::string description() const override { return description_; }
  std::int64_t length() const override { return 0; }
  /// Does nothing if the fluid was already started at this step: a session starts it before it plays it.
  void start(std::int64_t start_step) override;
  /// A step before the current one restarts the simulation.
  FrameFacts prepare(std::int64_t step) override;
  void draw(const Canvas& canvas) override;
  /// The simulation at the prepared step; exists from the first start() or prepare() on.
  sim::Simulation& simulation() { return *simulation_; }
  /// Of all frames since the stimulus was made, also those before a rewind.
  const sim::GuardCounts& guards() const { return guards_; }
  /// True if the method uses the picture of the last frame, so that every frame must be drawn.
  bool follows_picture() const { return simulation_ && simulation_->follows_picture(); }
  /// Depth of the last picture, lowest row first; infinite where there is no fluid (GBuffer::depth).
  std::vector<float> read_depth() const { return picture_->renderer().read_depth(); }
  /// Pass times of the last picture; empty unless the render options ask for them (FluidRenderer::times).
  std::vector<sim::PassTime> pass_times() const {
    return picture_ ? picture_->renderer().times() : std::vector<sim::PassTime>();
  }

 private:
  void advance();
  void look();
  void tell_frame_time();

  sim::Scene scene_;
  double frame_dt_s_;
  std::string description_;
  MakeSimulation make_;
  Viewing viewing_;
  sim::RenderOptions options_;
  std::unique_ptr<sim::Simulation> simulation_;
  sim::GuardCounts guards_;
  std::int64_t step_ = 0;
  bool started_ = false;  ///< start() was called, and no step was prepared since
  std::optional<std::chrono::steady_clock::time_point> prepared_;
  std::unique_ptr<sim::FluidPicture> picture_;
  std::optional<sim::View> view_;  ///< of the last picture; in stereo, of the left eye
  bool stereo_ = false;            ///< the last picture has two eyes
  std::optional<sim::TemperatureScale> painted_;
  std::vector<float> temperature_k_;  ///< temperatures above the reference in the current picture
  double visual_scale_ = 1;           ///< of the last picture, as sim::EyeLook::visual_scale
};

/// What `vip-study run` shows: a bake if one is named, otherwise a live simulation.
struct StimulusChoice {
  std::filesystem::path bake;
  std::filesystem::path scene;
  std::string method = "HiRes";
  std::string n_star = "32k";
  std::string backend = "auto";
  double content_step_s = 0;  ///< fluid time per content step; 0 = that of the scene or the bake
  /// Live fluid only: frame rate from which temporal acceleration computes tau. None = the measured rate.
  std::optional<sim::FrameRate> fixed_rate;
  /// Live fluid only: all knobs of the solver, for this method and n_*; tau then follows from its beta and
  /// not from a frame rate. None = the default knobs.
  std::optional<sim::SolverSetting> setting = {};
  stats::PtpeModel model;
  /// Live fluid only: effects that replace those of the scene's file. None = the file's.
  std::optional<std::vector<sim::Effect>> effects = {};
  std::optional<std::vector<sim::PictureEffect>> picture_effects = {};  ///< likewise
  bool paint_temperature = false;  ///< paints temperatures over the water; not in a bake with pictures
  Viewing viewing;                 ///< ignored for a bake with pictures
  bool overview = false;           ///< live fluid only: uses the scene's camera for figures
  sim::RenderOptions render = {};  ///< live fluid only
};

/// base::Error for files that cannot be read, unknown words, and a bake whose frame interval differs from
/// content_step_s.
std::unique_ptr<Stimulus> make_stimulus(const StimulusChoice& choice);

/// As make_stimulus(), always live. settling: see SimulationOptions::settling.
std::unique_ptr<LiveFluid> make_live_fluid(const StimulusChoice& choice,
                                           const std::function<void(int, int)>& settling = {});

/// True if the choice is a bake with pictures; HeadlessDisplay's only_copies is then enough.
bool shows_pictures(const StimulusChoice& choice);

/// Converts the solver's account of a frame into the facts that the frame's record stores.
FrameFacts to_facts(double simulation_time_s, const sim::FrameAccount& account);

}  // namespace study
