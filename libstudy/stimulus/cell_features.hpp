#pragma once
/// Features of a protocol's cells, measured on their pictures and cached.

#include <filesystem>
#include <functional>
#include <map>

#include "libstudy/observer/picture_features.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/stimulus/fluid_stimulus.hpp"

namespace study {

/// Each cell is run live for 240 content steps from start_frame, its pictures drawn at 640 x 360 and measured
/// three in a row at every 30th; features are the means. Results are cached in `folder`, one file per cell,
/// keyed by cell, stimulus and program version. The gaze is at the middle of the visible fluid. Needs a GL
/// context if a cell is not cached.
class CellFeatures final : public FeatureSource {
 public:
  /// choice_of: returns the live stimulus of a cell.
  CellFeatures(std::filesystem::path folder, std::function<StimulusChoice(const Cell&)> choice_of)
      : folder_(std::move(folder)), choice_of_(std::move(choice_of)) {}

  /// Measures all cells of a protocol, with a progress bar, so that the session need not measure.
  void measure(const Protocol& protocol);
  /// base::Error for a cell that measure() did not measure.
  PictureFeatures of(const StimulusSpec& stimulus) override;

 private:
  PictureFeatures read_or_measure(const Cell& cell, std::int64_t start_frame) const;

  std::filesystem::path folder_;
  std::function<StimulusChoice(const Cell&)> choice_of_;
  std::map<std::string, PictureFeatures> known_;
};

/// "scene, method, n_*", with ", effects foam" if effects are a factor: names a cell's stimulus.
std::string stimulus_words(const StimulusSpec& stimulus);

}  // namespace study
