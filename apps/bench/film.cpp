#include "apps/bench/film.hpp"

#include "apps/bench/checkpoint.hpp"
#include "apps/bench/onlooker.hpp"
#include "apps/common/program.hpp"
#include "libsim/scene/gaze.hpp"
#include "stats/image/flicker.hpp"
#include "stats/image/ssim.hpp"

namespace apps {

namespace {

/// One simulation with its own eye, frame by frame.
class Reel {
 public:
  Reel(const CellScene& scene, const Table1Options& options, const sim::SimulationOptions& choice)
      : method_(choice.method),
        fluid_(sim::make_simulation(scene.scene, choice)),
        eye_(scene.scene, options.size) {
    // Saliency sees the settled water before the first frame, as it would in a live run.
    eye_.draw(*fluid_);
  }

  void step(const sim::Vec3d& gaze_m) {
    eye_.step(*fluid_, method_, gaze_m, true);
    std::swap(before_, now_);
    now_ = eye_.picture();
  }

  sim::MethodKind method() const { return method_; }
  const sim::Simulation& fluid() const { return *fluid_; }
  const Picture& now() const { return now_; }
  stats::FrameStep change() const { return {before_.view(), now_.view()}; }

  double ssim = 0, flicker = 0;  ///< sums over frames

 private:
  sim::MethodKind method_;
  std::unique_ptr<sim::Simulation> fluid_;
  Onlooker eye_;
  Picture before_, now_;
};

void compare(const Reel& reference, Reel& reel, int frame) {
  reel.ssim += stats::ssim_map(reel.now().view(), reference.now().view()).mean().value;
  if (frame >= 2) reel.flicker += stats::flicker(reel.change(), reference.change()).value;
}

}  // namespace

void run_film(const CellScene& scene, const CellSize& size, const Table1Options& options, ScoreBlock& block) {
  const auto choose = [&](sim::MethodKind method) {
    return run_options(options, scene, size, block.preset, method);
  };
  Reel reference(scene, options, choose(sim::MethodKind::HiRes));
  const auto settled = reference.fluid().read_state();
  std::vector<std::unique_ptr<Reel>> reels;
  for (const auto& scores : block.methods) {
    auto choice = choose(scores.method);
    // LoRes fills and settles for itself; the others begin with HiRes' particles.
    if (scores.method != sim::MethodKind::LoRes)
      choice.start =
          perturbed(settled, scores.method == sim::MethodKind::HiRes && !options.unperturbed ? 1 : 0);
    reels.push_back(std::make_unique<Reel>(scene, options, choice));
  }
  const int frames = options.cumul_frames;
  Progress progress("frames of the film", static_cast<std::size_t>(frames));
  for (int frame = 1; frame <= frames; ++frame) {
    const sim::Vec3d gaze = sim::gaze_point(scene.scene, frame);
    reference.step(gaze);
    for (auto& reel : reels) {
      reel->step(gaze);
      compare(reference, *reel, frame);
    }
    progress.update(static_cast<std::size_t>(frame));
  }
  const auto pixels = reference.now().view().pixels();
  for (std::size_t m = 0; m < reels.size(); ++m) {
    const auto put = [&](Metric metric, double value) {
      block.methods[m].of(metric) = {{{value, pixels}}, 1};
    };
    put(Metric::SsimCumul, reels[m]->ssim / frames);
    if (frames >= 2) put(Metric::Flicker, reels[m]->flicker / (frames - 1));
  }
}

}  // namespace apps
