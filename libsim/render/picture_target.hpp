#pragma once
/// Destination of a compute shader's picture for a framebuffer. Internal to the renderer.

#include <memory>
#include <span>

#include "libsim/render/offscreen.hpp"
#include "libsim/view/camera.hpp"

namespace sim {

/// Image unit 0 as access to a framebuffer: its own texture if that is RGBA8, otherwise an internal picture,
/// which is copied. Pixels keep their coordinates. Needs a current context at every call and when destroyed.
class PictureTarget {
 public:
  /// Pixels stored between begin() and end() reach the views' viewports in the framebuffer.
  void begin(unsigned framebuffer, std::span<const View> views);
  void end(unsigned framebuffer, std::span<const View> views) const;

 private:
  bool copies_ = false;
  std::unique_ptr<Offscreen> own_;
};

}  // namespace sim
