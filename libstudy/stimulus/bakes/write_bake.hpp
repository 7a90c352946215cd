#pragma once
/// Computes a bake with the same steps as a live session, and reads a complete bake to check it.

#include <functional>

#include "libsim/bake/bake_file.hpp"
#include "libsim/gl/gl_context.hpp"
#include "libstudy/stimulus/bakes/bake_order.hpp"

namespace study {

struct BakeHooks {
  std::function<void(int, int)> settling;    ///< called after each settling frame with (done, total)
  std::function<void(std::int64_t)> frames;  ///< called after each frame with the number of written frames
  std::function<void()> stop = [] {};        ///< called before each frame; may throw to stop baking
};

/// True if making a bake with this header needs an OpenGL context, because it stores pictures or its method
/// follows the gaze in a picture.
inline bool draws(const sim::BakeHeader& header) { return header.view.drawn(); }

/// Writes the bake with the header header_of(order) to `out`, completely or not at all. Needs a current GL
/// context if draws(header). Throws the errors of sim::BakeWriter, and base::Error if the fluid has
/// non-finite values.
sim::BakeSizes write_bake(const BakeOrder& order, sim::BakeHeader header, const std::filesystem::path& out,
                          bool overwrite, const BakeHooks& hooks);

/// Results of reading a bake. Speeds are in frames per second that were read, checked and decoded.
struct ReadingSpeed {
  double particles = 0;
  double pictures = 0;             ///< 0 if the bake has no pictures
  double temperature_error_k = 0;  ///< largest error of the stored temperatures in any frame, K
};

/// Reads all frames of a bake; shows a progress bar if this takes long. `stop` is called before each frame
/// and may throw to stop reading. base::Error for the first damaged frame.
ReadingSpeed read_whole(
    const sim::BakeReader& bake, const std::function<void()>& stop = [] {});

}  // namespace study
