/// The last frame's picture for saliency: through the host, and on the device where CUDA shares memory with
/// GL (suites that end in Gpu). Both must give the same values.

#include <epoxy/gl.h>

#include "libsim/simulation.hpp"
#include "stats/base/error.hpp"
#include "tests/libsim/render/scene_fixture.hpp"

namespace {

using sim::Backend;
using sim::PictureWay;

/// A column of water in a corner of a tank, seen from the front.
sim::Scene dam() {
  sim::Scene scene;
  scene.name = "dam";
  scene.tank_size_m = {4.8, 4, 2.4};
  scene.water.front().min_m = {0, 0, 0};
  scene.water.front().max_m = {2.4, 2.4, 1.2};
  scene.gate = false;
  scene.settle_frames = 0;
  scene.v_ref_m_s = 4;
  scene.view.eye_m = {2.4, 1.6, 5.2};
  scene.view.target_m = {2.4, 1, 1.2};
  return scene;
}

class SharedPicture : public ::testing::Test {
 protected:
  void make(Backend backend) {
    sim::SimulationOptions options;
    options.method = sim::MethodKind::Ours;
    options.backend = backend;
    options.n_star = 256;
    fluid = sim::make_simulation(dam(), options);
  }

  void draw(int width, int height) {
    view = sim::make_view(dam().view, width, height);
    target = std::make_unique<sim::Offscreen>(width, height);
    buffer.reserve(fluid->particle_capacity());
    if (fluid->copy_to_gl(buffer.gl())) {
      buffer.set_count(fluid->particle_count());
    } else {
      fluid->read_particles(particles);
      buffer.upload(particles);
    }
    renderer->draw(buffer, {&view, 1}, target->framebuffer());
  }

  sim::Looks looks(const sim::GBuffer* seen, const sim::GlPicture* shared) const {
    return {{{{dam().view.eye_m, {0, -0.6, -4}, true}, view, seen, shared, fluid->frame()}}};
  }

  /// Saliency from the last picture must be equal through both paths.
  void expect_same_values() {
    sim::GBuffer seen;
    renderer->read_picture(seen);
    const sim::GlPicture shared = renderer->picture();
    std::vector<sim::ParticleSaliency> by_host, by_device;
    fluid->measure_saliency(looks(&seen, nullptr), by_host);
    fluid->measure_saliency(looks(nullptr, &shared), by_device);
    ASSERT_EQ(by_host.size(), by_device.size());
    int with_manifold = 0;
    for (std::size_t i = 0; i < by_host.size(); ++i) {
      ASSERT_EQ(by_host[i].manifold, by_device[i].manifold) << i;
      ASSERT_EQ(by_host[i].combined, by_device[i].combined) << i;
      ASSERT_EQ(by_host[i].s, by_device[i].s) << i;
      with_manifold += by_host[i].manifold > 0;
    }
    EXPECT_GT(with_manifold, 10) << "the picture must matter";
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
  }

  sim::GlContext context = sim::GlContext::make_headless();
  std::unique_ptr<sim::Simulation> fluid;
  std::unique_ptr<sim::FluidRenderer> renderer = std::make_unique<sim::FluidRenderer>(dam());
  std::unique_ptr<sim::Offscreen> target;
  sim::ParticleBuffer buffer;
  std::vector<sim::RenderParticle> particles;
  sim::View view;
};

class SharedPictureGl : public SharedPicture {};
class SharedPictureGpu : public SharedPicture {};

TEST_F(SharedPictureGl, TheSmallReadBackIsTheLargeOnesPart) {
  make(Backend::Cpu);
  draw(160, 120);
  const sim::GBuffer whole = renderer->read_gbuffer();
  sim::GBuffer part = whole;
  renderer->read_picture(part);
  EXPECT_EQ(part.depth, whole.depth);
  EXPECT_EQ(part.normal, whole.normal);
  EXPECT_TRUE(part.thickness.empty());
  EXPECT_EQ(part.view.view, whole.view.view);
  EXPECT_EQ(part.radius_scale, whole.radius_scale);
  EXPECT_THROW(renderer->picture(1), base::Error) << "one view was drawn";
}

TEST_F(SharedPictureGl, TheCpuRefusesAndTakesTheHostsWay) {
  make(Backend::Cpu);
  draw(160, 120);
  EXPECT_EQ(fluid->report().seen.way, PictureWay::None);
  const sim::GlPicture shared = renderer->picture();
  EXPECT_FALSE(fluid->look(looks(nullptr, &shared)));
  EXPECT_EQ(fluid->report().seen.way, PictureWay::None) << "a refused picture is not taken";
  std::vector<sim::ParticleSaliency> values;
  EXPECT_THROW(fluid->measure_saliency(looks(nullptr, &shared), values), base::Error);
  std::vector<sim::ParticleSaliency> without;
  fluid->measure_gaze_targets(looks(nullptr, &shared), values);
  fluid->measure_gaze_targets(looks(nullptr, nullptr), without);
  ASSERT_EQ(values.size(), without.size());
  bool near_gaze = false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(values[i].s, without[i].s);
    near_gaze |= values[i].s > 0;
  }
  EXPECT_TRUE(near_gaze) << "gaze targets need no picture";
  sim::GBuffer seen;
  renderer->read_picture(seen);
  fluid->step_frame();
  EXPECT_TRUE(fluid->look(looks(&seen, nullptr)));
  EXPECT_EQ(fluid->report().seen.way, PictureWay::Host);
  EXPECT_EQ(fluid->report().seen.frame, 1);
}

TEST_F(SharedPictureGl, BuffersTooSmallForThePictureAreRefused) {
  make(Backend::Cpu);
  draw(160, 120);
  sim::GlPicture shared = renderer->picture();
  shared.width *= 4;
  EXPECT_THROW(fluid->look(looks(nullptr, &shared)), base::Error);
}

TEST_F(SharedPictureGl, ABufferOfARecycledNameIsAnother) {
  sim::GlBuffer one;
  one.reserve(64);
  const sim::GlBufferRef before = one.ref();
  one.reserve(32);
  EXPECT_EQ(one.ref(), before) << "it had the room";
  one = sim::GlBuffer();
  one.reserve(64);
  EXPECT_NE(one.ref(), before) << "whatever its name is";
}

TEST_F(SharedPictureGpu, BothWaysGiveTheSameValues) {
  make(Backend::Cuda);
  draw(320, 240);
  const int period = sim::Readings{}.levels_period_frames;
  int taken = 0;
  for (int frame = 0; frame < 3 * period; ++frame) {
    const sim::GlPicture shared = renderer->picture();
    ASSERT_TRUE(fluid->look(looks(nullptr, &shared))) << "GL and CUDA must share a device here";
    const auto seen = fluid->report().seen;
    EXPECT_EQ(seen.way, PictureWay::Device);
    EXPECT_LE(seen.frame, frame);
    EXPECT_GT(seen.frame, frame - period) << "a turn takes the last frame's picture, other frames take none";
    taken += seen.frame == frame;
    fluid->step_frame();
    draw(320, 240);
  }
  EXPECT_GE(taken, 3);
  expect_same_values();
}

TEST_F(SharedPictureGpu, BuffersMayGoWhileTheSimulationHasThem) {
  make(Backend::Cuda);
  draw(320, 240);
  for (int round = 0; round < 3; ++round) {
    const sim::GlPicture shared = renderer->picture();
    ASSERT_TRUE(fluid->look(looks(nullptr, &shared)));
    renderer = std::make_unique<sim::FluidRenderer>(dam());
    buffer = sim::ParticleBuffer();
    fluid->step_frame();
    draw(320, 240);
    expect_same_values();
  }
  const sim::GlPicture shared = renderer->picture();
  ASSERT_TRUE(fluid->look(looks(nullptr, &shared)));
  fluid.reset();
  EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST_F(SharedPictureGpu, PicturesMayChangeSizeAndRenderer) {
  make(Backend::Cuda);
  for (const auto& [width, height] : {std::pair{320, 240}, {640, 480}, {200, 100}}) {
    draw(width, height);
    const sim::GlPicture shared = renderer->picture();
    ASSERT_TRUE(fluid->look(looks(nullptr, &shared)));
    fluid->step_frame();
    draw(width, height);
    expect_same_values();
    // GL reuses the names of its buffers for the next renderer.
    renderer = std::make_unique<sim::FluidRenderer>(dam());
  }
}

}  // namespace
