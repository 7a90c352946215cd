#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <utility>

#include "libsim/gl/gl_context.hpp"
#include "libsim/gl/offscreen.hpp"
#include "stats/base/error.hpp"

namespace {

TEST(GlContextGl, GivesCore45WithoutADisplay) {
  const auto context = sim::GlContext::make_headless();
  GLint profile = 0;
  glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
  EXPECT_EQ(profile, GL_CONTEXT_CORE_PROFILE_BIT);
  EXPECT_GE(epoxy_gl_version(), 45);
}

TEST(GlContextGl, MovesAndTakesTurnsOnOneThread) {
  auto first = sim::GlContext::make_headless();
  auto target = std::make_unique<sim::Offscreen>(3, 2);
  auto second = sim::GlContext::make_headless();
  auto moved = std::move(first);
  moved.make_current();
  glClearNamedFramebufferfv(target->framebuffer(), GL_COLOR, 0, std::array<float, 4>{1, 0, 0, 1}.data());
  const auto image = target->read();
  EXPECT_EQ(image.rgba[0], 255);
  EXPECT_EQ(image.rgba[1], 0);
  target.reset();
}

TEST(OffscreenGl, ReadsRowsFromTheTop) {
  const auto context = sim::GlContext::make_headless();
  const sim::Offscreen target(3, 2);
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer());
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, 1, 3, 1);  // the upper row as GL counts
  glClearColor(0, 1, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  const auto image = target.read();
  ASSERT_EQ(image.rgba.size(), 24u);
  EXPECT_EQ(image.rgba[1], 255);
  EXPECT_EQ(image.rgba[13], 0);
}

TEST(OffscreenGl, RefusesSizesThatNoDriverHas) {
  const auto context = sim::GlContext::make_headless();
  EXPECT_THROW(sim::Offscreen(0, 4), base::Error);
  EXPECT_THROW(sim::Offscreen(1 << 20, 4), base::Error);
}

}  // namespace
