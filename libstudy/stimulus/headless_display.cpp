#include "libstudy/stimulus/headless_display.hpp"

#include <epoxy/gl.h>

#include <cstdlib>

#include "libstudy/base/clock.hpp"

namespace study {

namespace {
sim::GlContext make_context(bool only_copies) {
  if (only_copies) setenv("LP_NUM_THREADS", "0", 0);
  return sim::GlContext::make_headless();
}
}  // namespace

HeadlessDisplay::HeadlessDisplay(int width_px, int height_px, bool only_copies)
    : context_(make_context(only_copies)),
      buffers_{sim::Offscreen(width_px, height_px), sim::Offscreen(width_px, height_px)} {}

std::string HeadlessDisplay::description() const {
  return "headless " + std::to_string(width_px()) + "x" + std::to_string(height_px()) + ", " +
         sim::gl_description();
}

void HeadlessDisplay::render(Stimulus& stimulus) {
  const sim::Offscreen& back = buffers_[1 - front_];
  stimulus.draw({back.framebuffer(), back.width(), back.height()});
  glFinish();
}

PresentTimes HeadlessDisplay::present(std::int64_t scheduled_ns, Clock& clock) {
  clock.wait_until(scheduled_ns);
  PresentTimes times;
  times.submitted_ns = clock.now_ns();
  front_ = 1 - front_;
  glFinish();
  times.gpu_done_ns = clock.now_ns();
  return times;
}

}  // namespace study
