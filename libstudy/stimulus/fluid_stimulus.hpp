#pragma once
/// Fluids as implementations of study::Stimulus: baked pictures, baked particles or a running simulation.
///
/// Each stimulus creates GL objects in the context that is current at its first draw(). So destroy stimuli
/// before the display that owns this context. A content step is one frame of the scene.

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
#include "libsim/surface/host_surface.hpp"
#include "libstudy/display/stimulus.hpp"
#include "libstudy/stimulus/framing.hpp"

namespace study {

/// Plays the pictures of a bake, which another thread decodes ahead. draw() uploads a picture and copies it
/// to the framebuffer. A framebuffer of another size gets the whole picture, scaled, between black bars.
class BakedPictures final : public Stimulus {
 public:
  explicit BakedPictures(std::unique_ptr<sim::BakeReader> bake);
  ~BakedPictures() override;

  std::string description() const override;
  std::int64_t length() const override { return bake_->header().frame_count; }
  /// Waits until pictures from start_step on are decoded; returns at once if decoding already continues at
  /// start_step.
  void start(std::int64_t start_step) override;
  FrameFacts prepare(std::int64_t step) override;
  void draw(const Canvas& canvas) override;
  /// Number of pictures since start() that were not decoded in time.
  std::int64_t waits() const { return ring_.waits(); }

 private:
  std::unique_ptr<sim::BakeReader> bake_;
  sim::PictureRing ring_;
  const sim::BakePicture* picture_ = nullptr;
  unsigned texture_ = 0, source_ = 0;  ///< GL names of the picture's texture and of its framebuffer
};

/// Renders the particle frames of a bake with their foam. With paint_temperature, paints temperatures over
/// the water if the bake stores temperatures. base::Error for a scene with free obstacles, which a bake of
/// particles does not store.
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
  sim::HostSurface surface_;
  std::optional<sim::TemperatureScale> painted_;
  sim::BakeFrame frame_;
  std::vector<sim::RenderParticle> places_;  ///< of the frame's particles, as drawn
  std::vector<sim::RenderShape> shapes_;
  std::unique_ptr<sim::FluidRenderer> renderer_;
  sim::ParticleBuffer particles_, foam_;
};

/// A running simulation. It advances one frame per content step, and its method gets the picture that was
/// drawn last.
class LiveFluid final : public Stimulus {
 public:
  /// Makes the simulation at frame 0; called again for each rewind.
  using MakeSimulation = std::function<std::unique_ptr<sim::Simulation>()>;

  /// paint_temperature: paints temperatures over the water if the scene has heat.
  LiveFluid(const sim::Scene& scene, double frame_dt_s, std::string description, MakeSimulation make,
            Viewing viewing = {}, const sim::RenderOptions& options = {}, bool paint_temperature = false);

  std::string description() const override { return description_; }
  std::int64_t length() const override { return 0; }
  /// Brings the fluid to start_step. Does nothing if the fluid was already started at this step, because a
  /// session calls start() before the showing and again in it.
  void start(std::int64_t start_step) override;
  /// Advances the fluid to `step`. Restarts the simulation if `step` is before the current step.
  FrameFacts prepare(std::int64_t step) override;
  void draw(const Canvas& canvas) override;
  /// The simulation at the prepared step; exists from the first start() or prepare() on.
  sim::Simulation& simulation() { return *simulation_; }
  /// How often each of the solver's safety rules, such as the speed limit, intervened in all frames since the
  /// stimulus was made, including frames before a rewind.
  const sim::GuardCounts& guards() const { return guards_; }
  /// True if the simulation needs a picture of every frame (Simulation::needs_every_picture). False before
  /// start().
  bool needs_every_picture() const { return simulation_ && simulation_->needs_every_picture(); }
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
  bool started_ = false;  ///< start() was called, and prepare() was not called since
  std::optional<std::chrono::steady_clock::time_point> prepared_;
  std::unique_ptr<sim::FluidPicture> picture_;
  std::optional<sim::View> view_;  ///< view of the last picture; in stereo, of the left eye
  bool stereo_ = false;            ///< true: the last picture was drawn for two eyes
  std::optional<sim::TemperatureScale> painted_;
  /// Temperatures above the reference of the particles in the last picture, K.
  std::vector<float> temperature_k_;
  double visual_scale_ = 1;  ///< of the last picture: Framing::visual_scale(); 1 in stereo
};

/// Parameters of a stimulus: a bake if `bake` is set, otherwise a live simulation.
struct StimulusChoice {
  std::filesystem::path bake;
  std::filesystem::path scene;
  std::string method = "HiRes";
  std::string n_star = "32k";
  std::string backend = "auto";
  double content_step_s = 0;  ///< fluid time per content step; 0 = that of the setting, scene or bake
  /// Live fluid only: frame rate from which temporal acceleration computes its tolerance tau. None = the
  /// measured frame rate.
  std::optional<sim::FrameRate> fixed_rate;
  /// Live fluid only: all numbers of the solver; it replaces `method`, `n_star`, `fixed_rate` and `model`.
  /// tau then follows from the setting's beta instead of a frame rate. None = the default numbers.
  std::optional<sim::SolverSetting> setting = {};
  stats::PtpeModel model;  ///< live fluid only: model from which tau follows for a frame rate
  /// Live fluid only: effects that replace the effects of the scene's file. None = the effects of the file.
  std::optional<std::vector<sim::Effect>> effects = {};
  std::optional<std::vector<sim::PictureEffect>> picture_effects = {};  ///< live fluid only: as `effects`
  /// How the particles are drawn, sim::surface_name(). Empty: as `render` says, and a new bake does not
  /// record it. Ignored for a bake with pictures, which are drawn already.
  std::string surface = {};
  bool paint_temperature = false;  ///< paints temperatures over the water, if bake or scene have temperatures
  Viewing viewing;                 ///< ignored for a bake with pictures
  bool overview = false;           ///< live fluid only: uses the camera Scene::overview
  sim::RenderOptions render = {};  ///< ignored for a bake with pictures; see `surface`
};

/// Makes the stimulus of a choice. base::Error for files that cannot be read, unknown words, and a bake whose
/// frame interval differs from content_step_s.
std::unique_ptr<Stimulus> make_stimulus(const StimulusChoice& choice);

/// Makes the live fluid of a choice and ignores its `bake`. settling: called after each settling frame with
/// (done, total).
std::unique_ptr<LiveFluid> make_live_fluid(const StimulusChoice& choice,
                                           const std::function<void(int, int)>& settling = {});

/// True if the choice is a bake with pictures. HeadlessDisplay may then set only_copies.
bool shows_pictures(const StimulusChoice& choice);

/// Converts the solver's account of a frame into the facts that the frame's record stores.
FrameFacts to_facts(double simulation_time_s, const sim::FrameAccount& account);

}  // namespace study
