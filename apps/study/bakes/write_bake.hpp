#pragma once
/// Computes a bake as a session would have shown it live.

#include <functional>

#include "apps/study/bakes/bake_order.hpp"
#include "libsim/render/gl_context.hpp"

namespace apps {

struct BakeHooks {
  std::function<void(int, int)> settling;    ///< as SimulationOptions::settling
  std::function<void(std::int64_t)> frames;  ///< how many frames are written; after each
  std::function<void()> stop = [] {};        ///< asked before each frame; ends the work by throwing
};

/// Whether a bake with this header takes an OpenGL context to make: pictures are kept or followed.
inline bool draws(const sim::BakeHeader& header) { return header.view.drawn(); }

/// Writes the bake whose header_of() is `header` to `out`, completely or not at all. A GL context is current
/// where draws(). Errors as header_of() and sim::BakeWriter; water that broke is one too.
sim::BakeSizes write_bake(const BakeOrder& order, sim::BakeHeader header, const std::filesystem::path& out,
                          bool overwrite, const BakeHooks& hooks);

}  // namespace apps
