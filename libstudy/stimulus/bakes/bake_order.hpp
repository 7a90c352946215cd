#pragma once
/// What a bake should hold, and how an existing bake differs from that.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/stimulus/fluid_stimulus.hpp"
#include "stats/base/picture_size.hpp"

namespace study {

/// The order for one bake. `fluid` gives scene, method, n_*, back end, content step, frame rate, PTPE model
/// and the picture's visual angle; its gaze is not used.
struct BakeOrder {
  StimulusChoice fluid;
  std::int64_t frames = 600;          ///< content steps, including the start
  base::PictureSize size{1280, 720};  ///< of the picture that is stored or that the method follows
  bool pictures = false;              ///< store pictures besides the particles
  /// True: the gaze follows the scene's gaze keys; false: the picture's middle, as in a session with
  /// fixation.
  bool scene_gaze = false;
};

/// The header of the bake without fields known only after baking: back end, renderer, particles and their
/// radii. base::Error: unreadable scene, unknown words, or a method with temporal acceleration without a
/// frame rate for its tau.
sim::BakeHeader header_of(const BakeOrder& order);

/// Differences between the fluid of a bake and the wanted one, such as "n_* 2048 instead of 32768": scene,
/// method, n_*, content step, too few frames, and, where they matter, tau and the gaze. Empty: none.
std::vector<std::string> fluid_departures(const sim::BakeHeader& found, const sim::BakeHeader& wanted);

/// Differences of the stored or followed picture: its size and angles. Empty: none, or nothing was drawn.
std::vector<std::string> view_departures(const sim::BakeHeader& found, const sim::BakeHeader& wanted);

}  // namespace study
