#pragma once
/// A display without a screen: it draws every frame into framebuffers of a headless GL context.

#include <array>

#include "libsim/gl/gl_context.hpp"
#include "libsim/gl/offscreen.hpp"
#include "libstudy/display/stimulus.hpp"

namespace study {

/// Double buffered. Use it only on the thread that made it. Destroy the stimuli that drew on it first.
class HeadlessDisplay final : public Display {
 public:
  /// With only_copies, software GL draws on the calling thread alone, so that no frame waits for a helper
  /// thread. This is fast enough for baked pictures. If the environment sets Mesa's LP_NUM_THREADS, that
  /// value is used instead. base::Error for no OpenGL 4.5 or a size out of range.
  HeadlessDisplay(int width_px, int height_px, bool only_copies = false);

  std::string description() const override;
  TimingGrade grade() const override { return TimingGrade::CpuSubmit; }
  double refresh_hz() const override { return 0; }
  /// Draws into the back buffer and waits until the GPU has finished.
  void render(Stimulus& stimulus) override;
  /// Waits until scheduled_ns and swaps the buffers. No drawing is pending, so the times gpu_done and
  /// submitted are almost equal.
  PresentTimes present(std::int64_t scheduled_ns, Clock& clock) override;

  /// The picture in the front buffer.
  sim::Image read() const { return buffers_[front_].read(); }
  int width_px() const { return buffers_[0].width(); }
  int height_px() const { return buffers_[0].height(); }

 private:
  sim::GlContext context_;
  std::array<sim::Offscreen, 2> buffers_;
  std::size_t front_ = 0;
};

}  // namespace study
