#include "libsim/measure/table1.hpp"

#include <functional>

#include "libsim/measure/checkpoint.hpp"
#include "libsim/measure/masks.hpp"
#include "libsim/measure/onlooker.hpp"
#include "libsim/scene/gaze.hpp"
#include "libsim/setting/finite_water.hpp"
#include "stats/base/progress.hpp"
#include "stats/image/flicker.hpp"
#include "stats/image/ssim.hpp"

namespace measure {

namespace {

constexpr double periphery_deg = 20;

/// The run of one method, drawn by a camera of its own in each frame, and the sums of its metrics.
class Reel {
 public:
  Reel(const sim::CellScene& scene, const Table1Options& options, const sim::SimulationOptions& choice)
      : method_(choice.method),
        fluid_(sim::make_simulation(scene.scene, choice)),
        eye_(scene.scene, options.size) {
    // Draws the settled water, because saliency uses this picture in the first frame, as in a live run.
    eye_.draw(*fluid_);
  }

  void step(const sim::Vec3d& gaze_m) {
    eye_.step(*fluid_, gaze_m, true);
    if (const auto& met = fluid_->account().guards) guards = sim::sum(guards, *met);
    std::swap(before_, now_);
    now_ = eye_.picture();
  }

  sim::MethodKind method() const { return method_; }
  const sim::Simulation& fluid() const { return *fluid_; }
  const Onlooker& eye() const { return eye_; }
  const sim::Picture& now() const { return now_; }
  stats::FrameStep change() const { return {before_.view(), now_.view()}; }

  double ssim = 0, flicker = 0, flicker_periphery = 0;  ///< sums over frames
  sim::GuardCounts guards;

 private:
  sim::MethodKind method_;
  std::unique_ptr<sim::Simulation> fluid_;
  Onlooker eye_;
  sim::Picture before_, now_;
};

void compare(const Reel& reference, Reel& reel, int frame, const Mask& periphery) {
  reel.ssim += stats::ssim_map(reel.now().view(), reference.now().view()).mean().value;
  if (frame < 2) return;
  reel.flicker += stats::flicker(reel.change(), reference.change()).value;
  reel.flicker_periphery += stats::flicker(reel.change(), reference.change(), periphery).value;
}

Mask beyond(Mask mask) {
  for (auto& on : mask) on = on == 0;
  return mask;
}

/// Runs HiRes, the reference, and all methods of a block in lockstep, and sums their metrics over frames. The
/// starts of different numbers `start` differ by an ulp.
class Film {
 public:
  Film(const sim::CellScene& scene, const CellSize& size, const Table1Options& options,
       const ScoreBlock& block, int start)
      : scene_(scene),
        choose_(
            [&](sim::MethodKind method) { return run_options(options, scene, size, block.preset, method); }),
        reference_(scene, options, choose_(sim::MethodKind::HiRes)) {
    const auto settled = reference_.fluid().read_state();
    for (const auto& scores : block.methods) {
      auto choice = choose_(scores.method);
      const auto& method = sim::traits_of(scores.method);
      // A method with coarser particles fills and settles its own water; the others start from HiRes'
      // particles.
      if (method.start_level > 0) {
        if (start > 1)
          choice.start = perturbed(sim::make_simulation(scene.scene, choice)->read_state(), start);
      } else {
        const bool moved = start > 1 || (!method.adaptive() && !options.unperturbed);
        choice.start = perturbed(settled, moved ? start : 0);
      }
      reels_.push_back(std::make_unique<Reel>(scene, options, choice));
    }
  }

  void step(int frame) {
    const sim::Vec3d gaze = sim::gaze_point(scene_.scene, frame);
    const auto& eye = reference_.eye();
    const Mask periphery = beyond(fovea_mask(eye.view(), sim::gaze_at(eye.camera(), gaze), periphery_deg));
    reference_.step(gaze);
    for (auto& reel : reels_) {
      reel->step(gaze);
      compare(reference_, *reel, frame, periphery);
    }
  }

  sim::GuardCounts guards() const {
    sim::GuardCounts out = reference_.guards;
    for (const auto& reel : reels_) out = sim::sum(out, reel->guards);
    return out;
  }

  void put(int frames, ScoreBlock& block) const {
    const auto pixels = reference_.now().view().pixels();
    for (std::size_t m = 0; m < reels_.size(); ++m) {
      const auto add = [&](Metric metric, double value) {
        block.methods[m].of(metric).cells.push_back({value, pixels});
      };
      add(Metric::SsimCumul, reels_[m]->ssim / frames);
      if (frames < 2) continue;
      add(Metric::Flicker, reels_[m]->flicker / (frames - 1));
      add(Metric::FlickerPeriphery, reels_[m]->flicker_periphery / (frames - 1));
    }
  }

 private:
  const sim::CellScene& scene_;
  std::function<sim::SimulationOptions(sim::MethodKind)> choose_;
  Reel reference_;
  std::vector<std::unique_ptr<Reel>> reels_;
};

}  // namespace

void run_film(const sim::CellScene& scene, const CellSize& size, const Table1Options& options,
              ScoreBlock& block) {
  const int frames = options.cumul_frames;
  base::Progress progress("frames of the film", static_cast<std::size_t>(frames * options.film_starts));
  sim::GuardCounts met;
  for (int start = 1; start <= options.film_starts; ++start) {
    Film film(scene, size, options, block, start);
    for (int frame = 1; frame <= frames; ++frame) {
      film.step(frame);
      progress.update(static_cast<std::size_t>((start - 1) * frames + frame));
    }
    film.put(frames, block);
    met = sim::sum(met, film.guards());
  }
  sim::print_guards(scene.name + ", n_* " + size.word + ", film", met, {});
}

}  // namespace measure
