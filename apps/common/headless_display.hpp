#pragma once
/// A display without a screen: frames are really drawn, into framebuffers of a headless GL context.

#include <array>

#include "libsim/render/gl_context.hpp"
#include "libsim/render/offscreen.hpp"
#include "libstudy/display/stimulus.hpp"

namespace apps {

/// Double buffered like a screen. Use it on the thread that made it; destroy stimuli that drew on it first.
class HeadlessDisplay final : public study::Display {
 public:
  /// With only_copies, software GL draws on the calling thread alone: enough for baked pictures, and no frame
  /// waits for a helper thread to be woken. ($LP_NUM_THREADS of Mesa, when set, decides instead.) Errors
  /// (base::Error): no OpenGL 4.5, a size out of range.
  HeadlessDisplay(int width_px, int height_px, bool only_copies = false);

  std::string description() const override;
  study::TimingGrade grade() const override { return study::TimingGrade::CpuSubmit; }
  double refresh_hz() const override { return 0; }
  /// Draws into the back buffer and waits until the device has finished.
  void render(study::Stimulus& stimulus) override;
  /// Makes the back buffer the front buffer. Nothing is left to draw, so submitted and done are one instant
  /// but for the check.
  study::PresentTimes present(std::int64_t scheduled_ns, study::Clock& clock) override;

  /// The picture on show.
  sim::Image read() const { return buffers_[front_].read(); }
  int width_px() const { return buffers_[0].width(); }
  int height_px() const { return buffers_[0].height(); }

 private:
  sim::GlContext context_;
  std::array<sim::Offscreen, 2> buffers_;
  std::size_t front_ = 0;
};

}  // namespace apps
