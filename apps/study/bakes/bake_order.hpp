#pragma once
/// What a bake is asked to hold, and in what one that is there differs from it.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/common/fluid_stimulus.hpp"
#include "apps/common/picture_size.hpp"

namespace apps {

/// One bake. `fluid` says scene, method, n_*, back end, content step, frame rate, PTPE model and how large
/// the eye sees the picture; its gaze is not asked.
struct BakeOrder {
  StimulusChoice fluid;
  std::int64_t frames = 600;    ///< content steps, the start among them
  PictureSize size{1280, 720};  ///< of the picture that is kept, or that the method follows
  bool pictures = false;        ///< keep them, beside the particles
  /// One looks along the scene's gaze keys; else at the middle of the picture, as in a session with fixation.
  bool scene_gaze = false;
};

/// The header of the bake, but for what its making tells: back end, renderer, particles and their radii.
/// base::Error: a scene that cannot be read, words that are not known, a method with temporal acceleration
/// and no frame rate that its tau follows from.
sim::BakeHeader header_of(const BakeOrder& order);

/// In what the fluid of a bake differs from what is wanted, such as "n_* 2048 instead of 32768": scene,
/// method, n_*, content step, too few frames, and where they matter tau and the gaze. Empty: in nothing.
std::vector<std::string> fluid_departures(const sim::BakeHeader& found, const sim::BakeHeader& wanted);

/// In what the picture differs that was kept or followed: its size and angles. Empty: in nothing, or nothing
/// was drawn.
std::vector<std::string> view_departures(const sim::BakeHeader& found, const sim::BakeHeader& wanted);

}  // namespace apps
