#include "libsim/measure/table1.hpp"

#include <algorithm>

#include "libsim/measure/checkpoint_file.hpp"

namespace measure {

namespace {

CheckpointOf checkpoint_of(const sim::CellScene& scene, const CellSize& size, const Table1Options& options,
                           int frame) {
  return {scene.name, scene.scene.sha256, size.n_star, frame, options.size};
}

}  // namespace

std::vector<int> checkpoint_frames(const sim::CellScene& scene, const Table1Options& options) {
  auto frames = scene.scene.checkpoints;
  if (options.checkpoints > 0)
    frames.resize(std::min(frames.size(), static_cast<std::size_t>(options.checkpoints)));
  return frames;
}

std::vector<std::string> stored_digests(const sim::CellScene& scene, const CellSize& size,
                                        const Table1Options& options) {
  std::vector<std::string> out;
  if (options.checkpoints_from.empty()) return out;
  for (const int frame : checkpoint_frames(scene, options)) {
    out.push_back(checkpoint_digest(
        read_checkpoint(options.checkpoints_from, checkpoint_of(scene, size, options, frame))));
  }
  return out;
}

std::vector<Checkpoint> take_checkpoints(const sim::CellScene& scene, const CellSize& size,
                                         const Table1Options& options, Onlooker& eye) {
  const auto frames = checkpoint_frames(scene, options);
  std::vector<Checkpoint> out;
  if (!options.checkpoints_from.empty()) {
    for (const int frame : frames) {
      out.push_back(read_checkpoint(options.checkpoints_from, checkpoint_of(scene, size, options, frame)));
    }
    return out;
  }
  // The choice of the preset has no effect: runs of HiRes are equal with each preset.
  const auto hires = sim::make_simulation(
      scene.scene, run_options(options, scene, size, sim::Preset::Tuned, sim::MethodKind::HiRes));
  for (int frame = 1; !frames.empty() && frame <= frames.back(); ++frame) {
    hires->step_frame();
    if (std::find(frames.begin(), frames.end(), frame) == frames.end()) continue;
    eye.begin(nullptr);
    eye.draw(*hires);
    out.push_back({frame, hires->read_state(), eye.gbuffer()});
    if (!options.checkpoints_to.empty()) {
      write_checkpoint(options.checkpoints_to, checkpoint_of(scene, size, options, frame), out.back());
    }
  }
  return out;
}

}  // namespace measure
