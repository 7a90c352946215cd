#include "libstudy/stimulus/fluid_stimulus.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libsim/surface/host_surface.hpp"
#include "libstudy/base/clock.hpp"
#include "libstudy/stimulus/headless_display.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/libsim/bake/make_bake.hpp"

namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string scene_text() { return base::read_file(base::resource("data/scenes/single_dam.toml"), 1 << 20); }
sim::Scene scene() { return sim::parse_scene(scene_text(), "single_dam.toml"); }

/// The particles of the test's bake; each step moves them to the bake's next frame.
class FakeSimulation final : public sim::Simulation {
 public:
  /// look() appends its argument to `looks`, unless that is null.
  explicit FakeSimulation(std::vector<sim::Looks>* looks = nullptr) : looks_(looks) {}
  bool look(const sim::Looks& looks) override {
    if (looks_) looks_->push_back(looks);
    return true;
  }
  bool follows_picture() const override { return false; }
  int frame() const override { return frame_; }
  void step_frame() override {
    account_ = bake_test::account(++frame_);
    account_.particles_by_level = {768, 192};
  }
  const sim::FrameAccount& account() const override { return account_; }
  sim::FrameReport report() override { return {}; }
  std::int64_t particle_count() const override { return 960; }
  double spacing_m() const override { return 0.1; }
  std::vector<float> radii_m() const override { return {}; }
  void read_particles(std::vector<sim::RenderParticle>& out) const override {
    out = bake_test::particles(frame_);
  }
  void read_surface(std::vector<sim::RenderParticle>& out, std::vector<sim::RenderShape>& shapes) override {
    read_particles(out);
    sim::HostSurface(scene()).shape(out, shapes);
  }
  void read_saliency(std::vector<sim::ParticleSaliency>& out) const override { out.clear(); }
  void measure_saliency(const sim::Looks&, std::vector<sim::ParticleSaliency>& out) override { out.clear(); }
  void measure_gaze_targets(const sim::Looks&, std::vector<sim::ParticleSaliency>& out) override {
    out.clear();
  }
  std::vector<int> read_ids() const override { return {}; }
  void read_field(sim::ParticleField, std::vector<float>& out) const override { out.clear(); }
  std::vector<sim::ParticleState> read_state() const override { return {}; }
  void save_state(const std::filesystem::path&) override {}
  sim::PartTimes part_times() const override { return {}; }
  bool copy_to_gl(const sim::GlBufferRef&) override { return false; }
  void synchronize() override {}
  std::size_t particle_bytes() const override { return 0; }
  std::string explain() const override { return ""; }

 private:
  std::vector<sim::Looks>* looks_;
  int frame_ = 0;
  sim::FrameAccount account_{{768, 192}, {}, {}};
};

/// Compares a frame's facts with bake_test::account(frame).
void expect_facts(const study::FrameFacts& facts, std::int64_t frame) {
  SCOPED_TRACE(frame);
  const sim::FrameAccount account = bake_test::account(frame);
  EXPECT_THAT(facts.particles_by_level, ElementsAre(768, 192));
  ASSERT_EQ(facts.tolerance.has_value(), account.temporal.has_value());
  ASSERT_EQ(facts.guards.has_value(), account.guards.has_value());
  if (!account.temporal) return;
  EXPECT_EQ(facts.tolerance->tau_fps, account.temporal->tau);
  EXPECT_EQ(facts.tolerance->beta, account.temporal->beta);
  EXPECT_DOUBLE_EQ(facts.tolerance->active_fraction, static_cast<double>(account.temporal->active) / 960);
  EXPECT_EQ(facts.tolerance->mu_fps.has_value(), account.temporal->rate.has_value());
  EXPECT_EQ(facts.tolerance->mu_fps.value_or(17.25), 17.25);
  EXPECT_EQ(facts.tolerance->delta_fps.value_or(3.5), 3.5);
  EXPECT_EQ(facts.guards->speed_limited, frame);
  EXPECT_EQ(facts.guards->gaze_lost, 8 * frame);
}

TEST(FluidStimulus, LiveFluidAdvancesOneFrameAStepAndBeginsAnewWhenItGoesBack) {
  int made = 0;
  study::LiveFluid fluid(scene(), 0.02, "fake", [&] {
    ++made;
    return std::make_unique<FakeSimulation>();
  });
  fluid.start(3);
  EXPECT_DOUBLE_EQ(fluid.prepare(3).simulation_time_s, 0.06);
  EXPECT_THAT(fluid.prepare(7).particles_by_level, ElementsAre(768, 192));
  EXPECT_DOUBLE_EQ(fluid.prepare(7).simulation_time_s, 0.14);
  EXPECT_EQ(made, 1);
  EXPECT_DOUBLE_EQ(fluid.prepare(2).simulation_time_s, 0.04);
  fluid.start(0);
  EXPECT_EQ(made, 3);
  EXPECT_EQ(fluid.length(), 0);
}

TEST(FluidStimulus, LiveFluidThatStandsAtItsStartIsNotComputedAgain) {
  int made = 0;
  study::LiveFluid fluid(scene(), 0.02, "fake", [&] {
    ++made;
    return std::make_unique<FakeSimulation>();
  });
  fluid.start(3);  // while the screen is black
  fluid.start(3);  // at the start of the trial
  EXPECT_EQ(made, 1);
  EXPECT_DOUBLE_EQ(fluid.prepare(3).simulation_time_s, 0.06);
  fluid.start(3);  // the next trial
  EXPECT_EQ(made, 2);
}

TEST(FluidStimulus, FramesHoldTheSolversAccountWhetherLiveOrBaked) {
  const bake_test::Folder folder;
  bake_test::write(folder / "a.bake", 7);
  study::LiveFluid live(scene(), 1.0 / 60, "fake", [] { return std::make_unique<FakeSimulation>(); });
  sim::BakeFrame frame;
  const sim::BakeReader baked(folder / "a.bake");
  live.start(0);
  for (int step = 0; step < 7; ++step) {
    expect_facts(live.prepare(step), step);
    baked.read_frame(step, frame);
    expect_facts(study::to_facts(frame.facts.time_s, frame.facts.account), step);
  }
}

TEST(FluidStimulus, FramesOfABakeOfFormat1MeasuredCountsAlone) {
  const auto file = base::resource("tests/libsim/bake/fixtures/format_1.bake");
  study::BakedPictures pictures(std::make_unique<sim::BakeReader>(file));
  pictures.start(0);
  const study::FrameFacts facts = pictures.prepare(0);
  EXPECT_FALSE(facts.particles_by_level.empty());
  EXPECT_FALSE(facts.tolerance || facts.guards);
}

TEST(FluidStimulus, BakeWithAnotherContentStepIsRefused) {
  const bake_test::Folder folder;
  bake_test::write(folder / "a.bake", 2, 32, 18);
  study::StimulusChoice choice;
  choice.bake = folder / "a.bake";
  choice.content_step_s = 0.01667;  // 1/60 as rounded in a protocol
  EXPECT_EQ(study::make_stimulus(choice)->length(), 2);
  EXPECT_TRUE(study::shows_pictures(choice));
  choice.content_step_s = 0.02;
  try {
    study::make_stimulus(choice);
    FAIL() << "accepted";
  } catch (const base::Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("a.bake: holds frames 0.0166667 s apart"));
  }
}

class FluidStimulusGl : public ::testing::Test {
 protected:
  /// The picture on the display, bottom row first.
  static sim::Bytes shown(const study::HeadlessDisplay& display) {
    const sim::Image image = display.read();
    const std::size_t row = 4 * static_cast<std::size_t>(image.width);
    sim::Bytes out;
    for (std::size_t y = static_cast<std::size_t>(image.height); y-- > 0;) {
      const auto begin = image.rgba.begin() + static_cast<std::ptrdiff_t>(y * row);
      out.insert(out.end(), begin, begin + static_cast<std::ptrdiff_t>(row));
    }
    return out;
  }
  bake_test::Folder folder_;
  study::RealClock clock_;
};

TEST_F(FluidStimulusGl, BakedPicturesAreShownExactly) {
  bake_test::write(folder_ / "a.bake", 40, 64, 36);
  study::HeadlessDisplay display(64, 36, true);
  study::BakedPictures pictures(std::make_unique<sim::BakeReader>(folder_ / "a.bake"));
  EXPECT_THAT(pictures.description(), HasSubstr("pictures of test, HiRes, n_* 64"));
  for (const int start : {0, 5}) {
    pictures.start(start);
    for (int step = start; step < 40; step += 3) {
      const study::FrameFacts facts = pictures.prepare(step);
      EXPECT_DOUBLE_EQ(facts.simulation_time_s, step / 60.0);
      expect_facts(facts, step);
      display.render(pictures);
      const study::PresentTimes times = display.present(clock_.now_ns(), clock_);
      EXPECT_GE(times.gpu_done_ns, times.submitted_ns);
      ASSERT_EQ(shown(display), bake_test::picture(step, 64, 36)) << step;
    }
  }
}

TEST_F(FluidStimulusGl, RenderStaysUnseenUntilItIsPresented) {
  bake_test::write(folder_ / "a.bake", 2, 64, 36);
  study::HeadlessDisplay display(64, 36, true);
  study::BakedPictures pictures(std::make_unique<sim::BakeReader>(folder_ / "a.bake"));
  pictures.start(0);
  for (const int step : {0, 1}) {
    pictures.prepare(step);
    display.render(pictures);
    if (step == 1) {
      EXPECT_EQ(shown(display), bake_test::picture(0, 64, 36));
    }
    display.present(clock_.now_ns(), clock_);
    EXPECT_EQ(shown(display), bake_test::picture(step, 64, 36));
  }
}

TEST_F(FluidStimulusGl, PicturesOfAnotherShapeStandBetweenBlackBars) {
  bake_test::write(folder_ / "a.bake", 1, 32, 18);
  study::HeadlessDisplay display(64, 64, true);
  study::BakedPictures pictures(std::make_unique<sim::BakeReader>(folder_ / "a.bake"));
  pictures.start(0);
  pictures.prepare(0);
  display.render(pictures);
  display.present(clock_.now_ns(), clock_);
  const sim::Bytes out = shown(display);
  const auto blue = [&](std::size_t x, std::size_t y) { return out[4 * (64 * y + x) + 2]; };
  EXPECT_EQ(blue(5, 13), 0);
  EXPECT_GE(blue(5, 15), 76);
  EXPECT_GE(blue(5, 48), 76);
  EXPECT_EQ(blue(5, 50), 0);
}

TEST_F(FluidStimulusGl, ParticlesOfASceneWithFreeObstaclesAreNotShown) {
  sim::BakeHeader header = bake_test::header(1);
  header.scene_text = base::read_file(base::resource("data/scenes/float.toml"), 1 << 20);
  {
    sim::BakeWriter writer(folder_ / "a.bake", header);
    writer.add_frame(0, bake_test::particles(0), bake_test::account(0));
    writer.finish();
  }
  try {
    study::BakedParticles baked(std::make_unique<sim::BakeReader>(folder_ / "a.bake"));
    FAIL() << "accepted";
  } catch (const base::Error& error) {
    EXPECT_NE(std::string(error.what()).find("not store the free obstacles"), std::string::npos);
  }
}

TEST_F(FluidStimulusGl, BakedParticlesLookLikeTheLiveOnes) {
  sim::BakeHeader header = bake_test::header(3);
  header.scene_text = scene_text();
  {
    sim::BakeWriter writer(folder_ / "a.bake", header);
    for (int i = 0; i < 3; ++i) writer.add_frame(i / 60.0, bake_test::particles(i), bake_test::account(i));
    writer.finish();
  }
  study::HeadlessDisplay display(96, 54);
  study::BakedParticles baked(std::make_unique<sim::BakeReader>(folder_ / "a.bake"));
  study::LiveFluid live(scene(), 1.0 / 60, "fake", [] { return std::make_unique<FakeSimulation>(); });
  const auto picture = [&](study::Stimulus& stimulus, int step) {
    stimulus.prepare(step);
    display.render(stimulus);
    display.present(clock_.now_ns(), clock_);
    return shown(display);
  };
  live.start(0);
  const sim::Bytes first = picture(live, 0), want = picture(live, 2), got = picture(baked, 2);
  // Positions in the bake differ by at most 0.15 mm, so few bytes differ by more than 8.
  std::size_t far = 0, moved = 0;
  for (std::size_t i = 0; i < want.size(); ++i) {
    far += std::abs(int(want[i]) - int(got[i])) > 8;
    moved += std::abs(int(want[i]) - int(first[i])) > 8;
  }
  EXPECT_LT(far, want.size() / 100);
  EXPECT_GT(moved, want.size() / 50);
}

TEST_F(FluidStimulusGl, ABakeOfParticlesIsDrawnWithTheSurfaceOfTheChoice) {
  sim::BakeHeader header = bake_test::header(1);
  header.scene_text = scene_text();
  {
    sim::BakeWriter writer(folder_ / "a.bake", header);
    writer.add_frame(0, bake_test::particles(0), bake_test::account(0));
    writer.finish();
  }
  study::HeadlessDisplay display(96, 54);
  const auto drawn = [&](const std::string& surface) {
    study::StimulusChoice choice;
    choice.bake = folder_ / "a.bake";
    choice.surface = surface;
    const auto stimulus = study::make_stimulus(choice);
    EXPECT_EQ(stimulus->description().find(", drawn as spheres") != std::string::npos, surface == "spheres");
    stimulus->prepare(0);
    display.render(*stimulus);
    display.present(clock_.now_ns(), clock_);
    return shown(display);
  };
  EXPECT_EQ(drawn(""), drawn("ellipsoids"));
  EXPECT_NE(drawn("spheres"), drawn("ellipsoids"));
}

TEST_F(FluidStimulusGl, LiveFluidIsToldWhereItsViewerLooksBeforeEachFrameAfterAPicture) {
  study::HeadlessDisplay display(64, 36);
  std::vector<sim::Looks> looks;
  study::Viewing viewing;
  viewing.gaze = [](int width, int height) { return std::optional(std::pair(0.25 * width, 0.5 * height)); };
  viewing.visual_angle_deg = [](int, int) { return 40.0; };
  study::LiveFluid live(
      scene(), 1.0 / 60, "fake", [&] { return std::make_unique<FakeSimulation>(&looks); }, viewing);
  live.start(0);
  live.prepare(1);
  EXPECT_TRUE(looks.empty());  // nothing was shown yet
  display.render(live);
  live.prepare(3);
  ASSERT_EQ(looks.size(), 2u);
  const sim::EyeLook& eye = looks[0].eyes.at(0);
  EXPECT_TRUE(eye.gaze.valid);
  // The camera has the scene's angle, and the gaze goes through a quarter of its width.
  const sim::View view = sim::make_view(scene().view, 64, 36);
  EXPECT_EQ(eye.view.projection, view.projection);
  const sim::Gaze expected = sim::gaze_through(view, 16, 18);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(eye.gaze.direction[k], expected.direction[k], 1e-6);
  const double half_degree = std::acos(-1.0) / 360;
  EXPECT_NEAR(eye.visual_scale,
              std::tan(40 * half_degree) / std::tan(scene().view.vertical_fov_deg * half_degree), 1e-12);
}

TEST_F(FluidStimulusGl, LiveFluidIsAWindowOntoTheSceneWhereThatIsAsked) {
  study::HeadlessDisplay display(64, 36);
  std::vector<sim::Looks> looks;
  study::Viewing viewing;
  viewing.visual_angle_deg = [](int, int) { return 40.0; };
  viewing.true_angle = true;
  study::LiveFluid live(
      scene(), 1.0 / 60, "fake", [&] { return std::make_unique<FakeSimulation>(&looks); }, viewing);
  live.start(0);
  live.prepare(1);
  display.render(live);
  live.prepare(2);
  ASSERT_EQ(looks.size(), 1u);
  sim::Camera camera = scene().view;
  camera.vertical_fov_deg = 40;
  const sim::EyeLook& eye = looks[0].eyes.at(0);
  EXPECT_EQ(eye.view.projection, sim::make_view(camera, 64, 36).projection);
  EXPECT_EQ(eye.visual_scale, 1);
}

}  // namespace
