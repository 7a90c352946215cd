#pragma once
/// A framebuffer object for drawing without a window, and reading pictures from any framebuffer.

#include "libsim/gl/png.hpp"

namespace sim {

/// A framebuffer with an RGBA8 colour texture, without depth. Needs a current context at every call and when
/// it is destroyed.
class Offscreen {
 public:
  /// base::Error for a side below 1 px or above the driver's limit.
  Offscreen(int width, int height);
  ~Offscreen();
  Offscreen(const Offscreen&) = delete;
  Offscreen& operator=(const Offscreen&) = delete;

  unsigned framebuffer() const { return framebuffer_; }
  unsigned texture() const { return texture_; }
  int width() const { return width_; }
  int height() const { return height_; }
  Image read() const;

 private:
  int width_, height_;
  unsigned framebuffer_ = 0;
  unsigned texture_ = 0;
};

/// The colours of a framebuffer object (0 = the window); waits until they are drawn.
Image read_framebuffer(unsigned framebuffer, int width, int height);

}  // namespace sim
