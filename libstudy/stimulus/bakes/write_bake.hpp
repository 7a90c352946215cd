#pragma once
/// Computes a bake as a session would have shown it live, and reads one from its first byte to its last.

#include <functional>

#include "libsim/bake/bake_file.hpp"
#include "libsim/gl/gl_context.hpp"
#include "libstudy/stimulus/bakes/bake_order.hpp"

namespace study {

struct BakeHooks {
  std::function<void(int, int)> settling;    ///< as SimulationOptions::settling
  std::function<void(std::int64_t)> frames;  ///< called after each frame with the number written
  std::function<void()> stop = [] {};        ///< called before each frame; may throw to end the work
};

/// True if making a bake with this header needs an OpenGL context: pictures are stored or followed.
inline bool draws(const sim::BakeHeader& header) { return header.view.drawn(); }

/// Writes the bake whose header_of() is `header` to `out`, completely or not at all. Needs a current GL
/// context if draws(). Errors as header_of() and sim::BakeWriter, and base::Error if the fluid has non-finite
/// values.
sim::BakeSizes write_bake(const BakeOrder& order, sim::BakeHeader header, const std::filesystem::path& out,
                          bool overwrite, const BakeHooks& hooks);

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
