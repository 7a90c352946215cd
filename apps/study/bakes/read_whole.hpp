#pragma once
/// Reads a bake from its first byte to its last.

#include <functional>

#include "libsim/bake/bake_file.hpp"

namespace apps {

/// Frames a second that were read, checked and decoded.
struct ReadingSpeed {
  double particles = 0;
  double pictures = 0;             ///< 0: there are none
  double temperature_error_k = 0;  ///< that the temperatures of any frame are off by at most
};

/// With a progress bar where it takes long. `stop` is asked before each frame; it ends the work by throwing.
/// base::Error for the first frame that is damaged.
ReadingSpeed read_whole(
    const sim::BakeReader& bake, const std::function<void()>& stop = [] {});

}  // namespace apps
