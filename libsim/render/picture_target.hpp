#pragma once
/// Where a compute shader writes a picture that a framebuffer is to hold. Internal to the renderer.

#include <memory>
#include <span>

#include "libsim/render/offscreen.hpp"
#include "libsim/view/camera.hpp"

namespace sim {

/// Image unit 0 as a window into a framebuffer: its own texture where that is RGBA8, else a picture of ours,
/// which is copied. Pixels keep their coordinates. Needs a current context at every call and when destroyed.
class PictureTarget {
 public:
  /// What is stored between both calls reaches the framebuffer's viewports of the views.
  void begin(unsigned framebuffer, std::span<const View> views);
  void end(unsigned framebuffer, std::span<const View> views) const;

 private:
  bool copies_ = false;
  std::unique_ptr<Offscreen> own_;
};

}  // namespace sim
