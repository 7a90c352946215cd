#pragma once
/// The fluid as a study shows it: baked pictures, baked particles or a running simulation behind
/// study::Stimulus.
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

#include "apps/common/fluid_picture.hpp"
#include "apps/common/framing.hpp"
#include "apps/common/solver_setting.hpp"
#include "apps/common/temperature_scale.hpp"
#include "libsim/bake/picture_ring.hpp"
#include "libsim/render/fluid_renderer.hpp"
#include "libsim/simulation.hpp"
#include "libstudy/display/stimulus.hpp"

namespace apps {

/// The pictures of a bake, decoded ahead. draw() uploads one and copies it; a framebuffer of another size
/// gets it scaled, whole, between black bars.
class BakedPictures final : public study::Stimulus {
 public:
  explicit BakedPictures(std::unique_ptr<sim::BakeReader> bake);
  ~BakedPictures() override;

  std::string description() const override;
  std::int64_t length() const override { return bake_->header().frame_count; }
  /// Returns when pictures are decoded ahead; at once when this is where they loop to.
  void start(std::int64_t start_step) override;
  study::FrameFacts prepare(std::int64_t step) override;
  void draw(const study::Canvas& canvas) override;
  /// How often a picture was not decoded in time since start().
  std::int64_t waits() const { return ring_.waits(); }

 private:
  std::unique_ptr<sim::BakeReader> bake_;
  sim::PictureRing ring_;
  const sim::BakePicture* picture_ = nullptr;
  unsigned texture_ = 0, source_ = 0;  ///< the picture, and a framebuffer to copy it from
};

/// The particle frames of a bake with their foam, drawn by the renderer. Temperatures are painted over them
/// where that is asked for and the bake holds them.
class BakedParticles final : public study::Stimulus {
 public:
  explicit BakedParticles(std::unique_ptr<sim::BakeReader> bake, Viewing viewing = {},
                          const sim::RenderOptions& options = {}, bool paint_temperature = false);

  std::string description() const override;
  std::int64_t length() const override { return bake_->header().frame_count; }
  void start(std::int64_t) override {}
  study::FrameFacts prepare(std::int64_t step) override;
  void draw(const study::Canvas& canvas) override;

 private:
  std::unique_ptr<sim::BakeReader> bake_;
  sim::Scene scene_;
  Viewing viewing_;
  sim::RenderOptions options_;
  std::optional<TemperatureScale> painted_;
  sim::BakeFrame frame_;
  std::unique_ptr<sim::FluidRenderer> renderer_;
  sim::ParticleBuffer particles_, foam_;
};

/// A simulation that advances one frame a content step, and sees what its viewer saw in the picture before.
class LiveFluid final : public study::Stimulus {
 public:
  /// Makes the simulation at frame 0; called again for each rewind.
  using MakeSimulation = std::function<std::unique_ptr<sim::Simulation>()>;

  /// paint_temperature: over the water, where the scene has heat.
  LiveFluid(const sim::Scene& scene, double frame_dt_s, std::string description, MakeSimulation make,
            Viewing viewing = {}, const sim::RenderOptions& options = {}, bool paint_temperature = false);

  std::string description() const override { return description_; }
  std::int64_t length() const override { return 0; }
  /// Nothing is computed when it stands there already: a session makes it ready before it plays it.
  void start(std::int64_t start_step) override;
  /// A step before the present one begins anew.
  study::FrameFacts prepare(std::int64_t step) override;
  void draw(const study::Canvas& canvas) override;
  /// The simulation at the prepared step; there is one from the first start() or prepare() on.
  sim::Simulation& simulation() { return *simulation_; }
  /// Whether the method looks at the picture of the last frame, so that every one must be drawn.
  bool follows_picture() const { return simulation_ && simulation_->follows_picture(); }
  /// Depth of the last picture, lowest row first; infinite where there is no fluid (GBuffer::depth).
  std::vector<float> read_depth() const { return picture_->renderer().read_depth(); }
  /// Of the last picture; empty unless its options said so (FluidRenderer::times).
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
  std::int64_t step_ = 0;
  bool started_ = false;  ///< and no step was prepared since
  std::optional<std::chrono::steady_clock::time_point> prepared_;
  std::unique_ptr<FluidPicture> picture_;
  std::optional<sim::View> view_;  ///< of the last picture; of two eyes the left one's
  bool stereo_ = false;            ///< likewise
  std::optional<TemperatureScale> painted_;
  std::vector<float> temperature_k_;  ///< of the present picture, above the reference
  double visual_scale_ = 1;           ///< likewise, sim::EyeLook's
};

/// What `vip-study run` shows: a bake when one is named, otherwise a live simulation.
struct StimulusChoice {
  std::filesystem::path bake;
  std::filesystem::path scene;
  std::string method = "HiRes";
  std::string n_star = "32k";
  std::string backend = "auto";
  double content_step_s = 0;  ///< fluid time of a content step; 0 = the scene's or the bake's
  /// Of temporal acceleration, live fluid only: what tau follows from, none = as measured.
  std::optional<sim::FrameRate> fixed_rate;
  /// Live fluid only: all knobs of the solver, of this method and n_*; tau then follows from its beta and no
  /// frame rate. None = the usual ones.
  std::optional<SolverSetting> setting = {};
  stats::PtpeModel model;
  /// Live fluid only: instead of the scene's own. None = those of its file.
  std::optional<std::vector<sim::Effect>> effects = {};
  std::optional<std::vector<sim::PictureEffect>> picture_effects = {};  ///< likewise
  bool paint_temperature = false;  ///< over the water, where it has temperatures; not of a bake with pictures
  Viewing viewing;                 ///< of a bake with pictures: nothing
  bool overview = false;           ///< live fluid is watched by the scene's camera for figures
  sim::RenderOptions render = {};  ///< of live fluid
};

/// Errors (base::Error): files that cannot be read, words that are not known, a bake whose frames lie another
/// time apart than content_step_s.
std::unique_ptr<study::Stimulus> make_stimulus(const StimulusChoice& choice);

/// The same without a bake. settling: as SimulationOptions::settling.
std::unique_ptr<LiveFluid> make_live_fluid(const StimulusChoice& choice,
                                           const std::function<void(int, int)>& settling = {});

/// True when the choice is a bake with pictures, which HeadlessDisplay's only_copies suits.
bool shows_pictures(const StimulusChoice& choice);

/// A frame's facts as its record keeps them, from the solver's account of it.
study::FrameFacts to_facts(double simulation_time_s, const sim::FrameAccount& account);

}  // namespace apps
