#pragma once
/// Reads a bake from its first byte to its last.

#include <functional>

#include "libsim/bake/bake_file.hpp"

namespace study {

/// Frames per second that were read, checked and decoded.
struct ReadingSpeed {
  double particles = 0;
  double pictures = 0;             ///< 0 if there are none
  double temperature_error_k = 0;  ///< largest error of the temperatures of any frame
};

/// Shows a progress bar if it takes long. `stop` is called before each frame and may throw to end the work.
/// base::Error for the first damaged frame.
ReadingSpeed read_whole(
    const sim::BakeReader& bake, const std::function<void()>& stop = [] {});

}  // namespace study
