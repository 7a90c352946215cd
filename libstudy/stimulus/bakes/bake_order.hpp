#pragma once
/// The wanted content of a bake (a file with precomputed frames of a fluid), and how an existing bake differs
/// from it.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/stimulus/fluid_stimulus.hpp"
#include "stats/base/picture_size.hpp"

namespace study {

/// What one bake is to contain. `fluid` gives scene, method, n_*, effects, surface, back end, content step,
/// frame rate, PTPE model and the visual angle of the picture. Leave its Viewing::gaze empty.
struct BakeOrder {
  StimulusChoice fluid;
  std::int64_t frames = 600;          ///< content steps, including the state at the start
  base::PictureSize size{1280, 720};  ///< size of stored pictures, and of the picture that contains the gaze
  bool pictures = false;              ///< true: also store pictures, not only particles
  /// True: the gaze follows the scene's gaze keys, the points to look at over time. False: the gaze is at the
  /// middle of the picture, as in a session with fixation.
  bool scene_gaze = false;
};

/// The header of the bake, without the fields that are known only after baking: back end, renderer, number of
/// particles and radii. base::Error for an unreadable scene, unknown words, a scene with free obstacles in a
/// bake without pictures, painted temperatures in a scene without heat, and temporal acceleration without a
/// frame rate, from which its tolerance tau follows.
sim::BakeHeader header_of(const BakeOrder& order);

/// Differences between the fluid of a bake and the wanted fluid, such as "n_* 2048 instead of 32768": scene,
/// method, n_*, effects, content step and too few frames. Compares foam, tau and gaze only if the wanted bake
/// uses them. Compares painted temperatures if `found` has pictures; otherwise `found` must store
/// temperatures if `wanted` paints them. Compares the surfaces of pictures, stored or followed. Compares
/// effects, foam and temperatures only for the same scene, tau
/// and gaze only for the same method. Empty: no differences.
std::vector<std::string> fluid_departures(const sim::BakeHeader& found, const sim::BakeHeader& wanted);

/// Differences between the views of two bakes (camera, picture size and angles). A bake has a view if it
/// stores pictures or its method follows the gaze in a picture. Empty: none, or one of the bakes has no view.
std::vector<std::string> view_departures(const sim::BakeHeader& found, const sim::BakeHeader& wanted);

}  // namespace study
