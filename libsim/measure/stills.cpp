#include "libsim/measure/table1.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "libsim/levels/coarsen.hpp"
#include "libsim/measure/cell_scores.hpp"
#include "libsim/measure/checkpoint_file.hpp"
#include "libsim/measure/masks.hpp"
#include "libsim/measure/onlooker.hpp"
#include "libsim/scene/fill.hpp"
#include "libsim/setting/finite_water.hpp"
#include "stats/image/psnr.hpp"
#include "stats/image/ssim.hpp"

namespace measure {

namespace {

using Method = sim::MethodKind;
using State = std::vector<sim::ParticleState>;

/// Result of one run: its picture, and the scores that do not depend on the gaze.
struct Shot {
  sim::Picture picture;
  stats::ImageScore overall, fluid, ssim;
  SheetColumn sheet;
};

/// Picture and masks of HiRes (the method whose particles are all finest) a few frames after a checkpoint:
/// the reference of all comparisons.
struct Reference {
  sim::Picture picture;
  Mask fluid;
  std::vector<Mask> fovea, salient;  ///< one per gaze point
};

stats::ImageScore masked_psnr(const sim::Picture& a, const sim::Picture& b, const Mask& mask) {
  const std::size_t pixels = pixels_of(mask);
  if (pixels < least_mask_pixels) return {std::numeric_limits<double>::quiet_NaN(), pixels};
  return stats::psnr_db(a.view(), b.view(), mask);
}

class Stills {
 public:
  Stills(const sim::CellScene& scene, const CellSize& size, const Table1Options& options,
         const std::vector<sim::Preset>& presets, const std::function<void()>& done, SheetWriter& sheets)
      : scene_(scene),
        size_(size),
        options_(options),
        presets_(presets),
        done_(done),
        sheets_(sheets),
        eye_(scene.scene, options.size) {}

  StillResult run() {
    for (const auto preset : presets_) result_.blocks.push_back(empty_block(scene_, size_, preset, options_));
    const auto checkpoints = take_checkpoints(scene_, size_, options_, eye_);
    for (auto& block : result_.blocks) {
      for (const auto& checkpoint : checkpoints) block.starts.push_back(checkpoint_digest(checkpoint));
    }
    for (const auto& checkpoint : checkpoints) compare_all(checkpoint);
    for (auto& start : result_.starts) start.particles_share /= start.starts;
    sim::print_guards(scene_.name + ", n_* " + size_.word + ", stills", guards_, {});
    return std::move(result_);
  }

 private:
  sim::SimulationOptions choose(Method method, sim::Preset preset) const {
    return run_options(options_, scene_, size_, preset, method);
  }

  void compare_all(const Checkpoint& checkpoint) {
    gazes_ = gaze_points(scene_.scene, checkpoint.frame, options_.gazes);
    const Reference reference = make_reference(checkpoint);
    std::vector<State> states;
    for (int r = 1; r <= options_.repeats; ++r)
      states.push_back(perturbed(checkpoint.state, options_.unperturbed ? 0 : r));
    const auto lores = shots(checkpoint, reference, Method::LoRes, presets_.front(), gazes_[0],
                             coarsened(states, std::vector<std::uint8_t>(checkpoint.state.size(), 3)));
    const auto hires = shots(checkpoint, reference, Method::HiRes, presets_.front(), gazes_[0], states);
    for (std::size_t p = 0; p < presets_.size(); ++p) {
      std::vector<SheetColumn> columns{lores[0].sheet, hires[0].sheet};
      for (std::size_t g = 0; g < gazes_.size(); ++g) {
        add(p, Method::LoRes, lores, reference, g);
        add(p, Method::HiRes, hires, reference, g);
        compare_adaptive(checkpoint, reference, states, p, g, columns);
      }
      write_sheet(checkpoint, presets_[p], columns);
    }
  }

  void compare_adaptive(const Checkpoint& checkpoint, const Reference& reference,
                        const std::vector<State>& states, std::size_t p, std::size_t g,
                        std::vector<SheetColumn>& columns) {
    const auto [by_gaze, by_saliency] = targets(checkpoint, presets_[p], gazes_[g]);
    const auto starts = coarsened(states, by_saliency);
    const auto run = [&](Method method, std::vector<State> from) {
      const auto taken = shots(checkpoint, reference, method, presets_[p], gazes_[g], std::move(from));
      add(p, method, taken, reference, g);
      if (g == 0) columns.push_back(taken[0].sheet);
    };
    for (const auto& traits : sim::all_methods()) {
      if (traits.target == sim::TargetSource::Gaze) run(traits.kind, coarsened(states, by_gaze));
      if (traits.target == sim::TargetSource::Saliency) run(traits.kind, starts);
    }
  }

  sim::EyeLook look_at(const sim::Vec3d& gaze_m, const sim::GBuffer& seen) const {
    return {sim::gaze_at(eye_.camera(), gaze_m), eye_.view(), &seen};
  }

  std::unique_ptr<sim::Simulation> start(const Checkpoint& checkpoint, Method method, sim::Preset preset,
                                         State state, int repeat) const {
    auto choice = choose(method, preset);
    choice.start = std::move(state);
    choice.start_frame = checkpoint.frame;
    choice.start_projections = options_.projections;
    choice.temporal.seed = static_cast<std::uint32_t>(repeat);
    return sim::make_simulation(scene_.scene, choice);
  }

  /// Target levels of the checkpoint's particles: first those from the gaze alone, then those from saliency.
  std::pair<std::vector<std::uint8_t>, std::vector<std::uint8_t>> targets(const Checkpoint& checkpoint,
                                                                          sim::Preset preset,
                                                                          const sim::Vec3d& gaze_m) const {
    auto choice = choose(Method::HiRes, preset);
    choice.start = checkpoint.state;
    const auto hires = sim::make_simulation(scene_.scene, choice);
    const sim::Looks looks{{look_at(gaze_m, checkpoint.seen)}};
    std::vector<sim::ParticleSaliency> values;
    hires->measure_saliency(looks, values);
    auto by_saliency = targets_by_id(checkpoint.state, hires->read_ids(), values);
    hires->measure_gaze_targets(looks, values);
    return {targets_by_id(checkpoint.state, hires->read_ids(), values), std::move(by_saliency)};
  }

  Reference make_reference(const Checkpoint& checkpoint) {
    const auto hires = start(checkpoint, Method::HiRes, sim::Preset::Tuned, checkpoint.state, 0);
    eye_.begin(&checkpoint.seen);
    for (int frame = 1; frame <= options_.frames_after; ++frame)
      eye_.step(*hires, gazes_[0], frame == options_.frames_after);
    done_();
    Reference out{eye_.picture(), eye_.fluid_mask(), {}, {}};
    const sim::GBuffer seen = eye_.gbuffer();
    const auto drawn_ids = hires->read_ids();
    const double fovea_deg = sim::readings_of(sim::Preset::Tuned).fovea_half_angle_deg;
    std::vector<sim::ParticleSaliency> values;
    std::vector<float> by_id(static_cast<std::size_t>(8 * size_.n_star));
    for (const auto& point : gazes_) {
      out.fovea.push_back(fovea_mask(eye_.view(), sim::gaze_at(eye_.camera(), point), fovea_deg));
      hires->measure_saliency({{look_at(point, seen)}}, values);
      const auto ids = hires->read_ids();
      for (std::size_t i = 0; i < ids.size(); ++i)
        by_id[static_cast<std::size_t>(ids[i])] = values[i].combined;
      out.salient.push_back(salient_mask(seen, drawn_ids, by_id, out.fovea.back()));
    }
    return out;
  }

  /// Merges the particles of each repeat's state to their target levels `wishes`.
  std::vector<State> coarsened(const std::vector<State>& states,
                               const std::vector<std::uint8_t>& wishes) const {
    std::vector<State> out(states.size());
#pragma omp parallel for schedule(dynamic)
    for (std::size_t r = 0; r < states.size(); ++r) out[r] = sim::coarsen(states[r], wishes);
    return out;
  }

  std::vector<Shot> shots(const Checkpoint& checkpoint, const Reference& reference, Method method,
                          sim::Preset preset, const sim::Vec3d& gaze_m, std::vector<State> states) {
    std::vector<Shot> out;
    int repeat = 0;
    for (auto& state : states) {
      const auto fluid = start(checkpoint, method, preset, std::move(state), ++repeat);
      if (repeat == 1) note_start(*fluid, method, preset);
      eye_.begin(&checkpoint.seen);
      for (int frame = 1; frame <= options_.frames_after; ++frame)
        eye_.step(*fluid, gaze_m, frame == options_.frames_after);
      out.push_back(take_shot(*fluid, reference, repeat == 1 && !options_.pictures.empty()));
      guards_ = sim::sum(guards_, fluid->report().guards);
      done_();
    }
    return out;
  }

  Shot take_shot(sim::Simulation& fluid, const Reference& reference, bool for_sheet) {
    const sim::Image image = eye_.image();
    Shot out;
    out.picture = sim::without_alpha(image);
    const auto own = eye_.fluid_mask();
    const auto either = grown_union(reference.fluid, own, image.width, image.height);
    out.overall = stats::psnr_db(out.picture.view(), reference.picture.view());
    out.fluid = masked_psnr(out.picture, reference.picture, either);
    out.ssim = stats::ssim_map(out.picture.view(), reference.picture.view()).mean();
    if (for_sheet) {
      const auto r = sim::resolution_of(scene_.scene, Method::HiRes, size_.n_star);
      out.sheet = {image, eye_.painted_by_level(fluid, r.finest_spacing_m)};
    }
    return out;
  }

  /// Records how many projections a method's start needed and how much compression remained. Called for the
  /// first repeat only, because the other repeats differ from it by an ulp.
  void note_start(sim::Simulation& fluid, Method method, sim::Preset preset) {
    auto& starts = result_.starts;
    auto found = std::find_if(starts.begin(), starts.end(), [&](const auto& start) {
      return start.method == method && start.preset == preset;
    });
    if (found == starts.end()) found = starts.insert(found, {method, preset, {}, 0, 0});
    const sim::RelaxedStart start = fluid.report().start;
    found->worst.projections = std::max(found->worst.projections, start.projections);
    found->worst.compression = std::max(found->worst.compression, start.compression);
    found->particles_share +=
        static_cast<double>(fluid.particle_count()) / (8 * static_cast<double>(size_.n_star));
    ++found->starts;
  }

  void add(std::size_t p, Method method, const std::vector<Shot>& taken, const Reference& reference,
           std::size_t g) {
    auto& scores = result_.blocks[p].methods[static_cast<std::size_t>(method)];
    for (const auto& shot : taken) {
      const auto put = [&](Metric metric, const stats::ImageScore& score) {
        scores.of(metric).cells.push_back(score);
      };
      put(Metric::PsnrFov, masked_psnr(shot.picture, reference.picture, reference.fovea[g]));
      put(Metric::PsnrSalient, masked_psnr(shot.picture, reference.picture, reference.salient[g]));
      put(Metric::PsnrOverall, shot.overall);
      put(Metric::PsnrFluid, shot.fluid);
      put(Metric::SsimStatic, shot.ssim);
    }
  }

  void write_sheet(const Checkpoint& checkpoint, sim::Preset preset,
                   const std::vector<SheetColumn>& columns) {
    if (options_.pictures.empty()) return;
    const std::string name = fmt::format("{}_{}_{}_f{:03}.png", scene_.name, size_.word,
                                         sim::preset_name(preset), checkpoint.frame);
    sheets_.write(std::filesystem::path(options_.pictures) / name, contact_sheet(columns));
  }

  const sim::CellScene& scene_;
  const CellSize& size_;
  const Table1Options& options_;
  const std::vector<sim::Preset>& presets_;
  const std::function<void()>& done_;
  SheetWriter& sheets_;
  Onlooker eye_;
  std::vector<sim::Vec3d> gazes_;
  StillResult result_;
  sim::GuardCounts guards_;  ///< of all shots
};

}  // namespace

ScoreBlock empty_block(const sim::CellScene& scene, const CellSize& size, sim::Preset preset,
                       const Table1Options& options) {
  ScoreBlock out{scene.name, size.word, preset, {}};
  out.checkpoints = checkpoint_frames(scene, options);
  out.gazes = options.gazes;
  for (const auto& traits : sim::all_methods()) {
    MethodScores scores;
    scores.method = traits.kind;
    for (const Metric metric : still_metrics)
      scores.of(metric).repeats = static_cast<std::size_t>(options.repeats);
    out.methods.push_back(scores);
  }
  return out;
}

std::size_t still_runs(const sim::CellScene& scene, const Table1Options& options, std::size_t presets) {
  const auto gazes = static_cast<std::size_t>(options.gazes);
  const auto repeats = static_cast<std::size_t>(options.repeats);
  const auto& methods = sim::all_methods();
  const auto adaptive = static_cast<std::size_t>(std::count_if(
      methods.begin(), methods.end(), [](const sim::MethodTraits& traits) { return traits.adaptive(); }));
  return checkpoint_frames(scene, options).size() * (1 + 2 * repeats + presets * gazes * adaptive * repeats);
}

StillResult run_stills(const sim::CellScene& scene, const CellSize& size, const Table1Options& options,
                       const std::vector<sim::Preset>& presets, const std::function<void()>& done,
                       SheetWriter& sheets) {
  return Stills(scene, size, options, presets, done, sheets).run();
}

}  // namespace measure
