#pragma once
/// Features of the pictures of a protocol's cells (granularity and flicker), measured and cached.

#include <filesystem>
#include <functional>
#include <map>

#include "libstudy/observer/picture_features.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/stimulus/fluid_stimulus.hpp"

namespace study {

/// Runs each stimulus live for 240 content steps from start_frame and draws it at 640 x 360 px. Around every
/// 30th step it measures granularity and flicker on three successive pictures; the features are the means.
/// The gaze is at the mean position of the visible fluid. Results are cached in `folder`, one file per
/// stimulus, start_frame, content step, tau and program version. Needs a GL context if a stimulus is not
/// cached.
class CellFeatures final : public FeatureSource {
 public:
  /// choice_of: returns the live stimulus of a cell.
  CellFeatures(std::filesystem::path folder, std::function<StimulusChoice(const Cell&)> choice_of)
      : folder_(std::move(folder)), choice_of_(std::move(choice_of)) {}

  /// Measures each stimulus of a protocol, in the first cell that shows it; shows a progress bar. Call it
  /// before the session.
  void measure(const Protocol& protocol);
  /// base::Error for a stimulus that measure() did not measure.
  PictureFeatures of(const StimulusSpec& stimulus) override;

 private:
  PictureFeatures read_or_measure(const Cell& cell, std::int64_t start_frame) const;

  std::filesystem::path folder_;
  std::function<StimulusChoice(const Cell&)> choice_of_;
  std::map<std::string, PictureFeatures> known_;
};

/// Name of a cell's stimulus: "scene, method, n_*", with ", effects foam" if the design varies effects.
std::string stimulus_words(const StimulusSpec& stimulus);

}  // namespace study
