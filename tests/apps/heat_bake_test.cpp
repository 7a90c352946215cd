/// Bakes of water with heat hold temperatures, and live and baked water are painted alike.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "apps/study/bake_protocol.hpp"
#include "libsim/gl/offscreen.hpp"
#include "libstudy/stimulus/bakes/write_bake.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps {
namespace {

using ::testing::Contains;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr std::int64_t frames = 31;
constexpr int width = 160, height = 90;

study::BakeOrder order_with(bool paint, bool pictures = false, const std::string& scene = "hot_jet") {
  study::BakeOrder order;
  order.fluid.scene = base::find_input("data/scenes/" + scene + ".toml");
  order.fluid.method = "LoRes";
  order.fluid.n_star = "512";
  order.fluid.backend = "cpu";
  order.fluid.paint_temperature = paint;
  order.frames = frames;
  order.size = {width, height};
  order.pictures = pictures;
  return order;
}

using Picture = std::vector<std::uint8_t>;

Picture picture_of(study::Stimulus& stimulus, const std::vector<study::EyeView>& eyes = {}) {
  const sim::Offscreen target(width, height);
  stimulus.start(0);
  stimulus.prepare(frames - 1);
  stimulus.draw({target.framebuffer(), width, height, eyes});
  return target.read().rgba;
}

std::unique_ptr<study::Stimulus> played(const std::filesystem::path& bake, bool paint) {
  study::StimulusChoice choice;
  choice.bake = bake;
  choice.paint_temperature = paint;
  return study::make_stimulus(choice);
}

/// Mean difference of the pictures' bytes, of 255.
double difference(const Picture& a, const Picture& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(double(a[i]) - double(b[i]));
  return sum / static_cast<double>(a.size());
}

TEST(HeatBakeGl, IsPaintedAsItWasLive) {
  NEEDS_EFFECTS;
  const test::TemporaryFolder folder;
  const auto context = sim::GlContext::make_headless();
  const auto bake = [&](const study::BakeOrder& order, const char* name) {
    study::write_bake(order, study::header_of(order), folder / name, true, {});
    return folder / name;
  };
  const auto particles = bake(order_with(false), "particles.bake");
  const auto pictures = bake(order_with(true, true), "pictures.bake");
  const auto bare = bake(order_with(false, true), "bare.bake");

  const Picture painted = picture_of(*study::make_live_fluid(order_with(true).fluid));
  const Picture plain = picture_of(*study::make_live_fluid(order_with(false).fluid));
  ASSERT_GT(difference(painted, plain), 10);
  EXPECT_LT(difference(painted, picture_of(*played(particles, true))), 0.3);
  EXPECT_LT(difference(plain, picture_of(*played(particles, false))), 0.3);
  EXPECT_EQ(painted, picture_of(*played(pictures, true)));
  EXPECT_EQ(plain, picture_of(*played(bare, false)));

  // Hot water is yellow and cold water dark blue: the jet has the most red and the least blue.
  std::int64_t yellow = 0, blue = 0;
  for (std::size_t i = 0; i < painted.size(); i += 4) {
    if (painted[i] > painted[i + 2] + 60 && painted[i + 1] > painted[i + 2] + 40) ++yellow;
    if (painted[i + 2] > painted[i] + 30) ++blue;
  }
  EXPECT_GT(yellow, 50);
  EXPECT_GT(blue, 20 * width) << "the pool";
}

TEST(HeatBakeGl, IsPaintedForBothEyes) {
  NEEDS_EFFECTS;
  const test::TemporaryFolder folder;
  study::write_bake(order_with(false), study::header_of(order_with(false)), folder / "a.bake", true, {});
  const auto context = sim::GlContext::make_headless();
  std::vector<study::EyeView> eyes(2);
  for (int i = 0; i < 2; ++i) {
    auto& eye = eyes[static_cast<std::size_t>(i)];
    eye.position_m[0] = 0.064 * i - 0.032;
    eye.left_rad = eye.down_rad = -0.4;
    eye.right_rad = eye.up_rad = 0.4;
    eye.x_px = i * width / 2;
    eye.width_px = width / 2;
    eye.height_px = height;
  }
  const auto half = [](const Picture& of, bool right) {
    Picture out;
    for (std::size_t i = 0; i < of.size(); ++i)
      if ((i / 4 % width >= width / 2) == right) out.push_back(of[i]);
    return out;
  };
  const Picture painted = picture_of(*played(folder / "a.bake", true), eyes),
                plain = picture_of(*played(folder / "a.bake", false), eyes),
                live = picture_of(*study::make_live_fluid(order_with(true).fluid), eyes);
  for (const bool right : {false, true}) {
    EXPECT_GT(difference(half(painted, right), half(plain, right)), 10);
    EXPECT_LT(difference(half(painted, right), half(live, right)), 0.3);
  }
}

TEST(HeatBake, HoldsTheTemperatureOfEachParticleWhateverIsPainted) {
  NEEDS_EFFECTS;
  const test::TemporaryFolder folder;
  const auto order = order_with(false);
  study::write_bake(order, study::header_of(order), folder / "a.bake", true, {});
  const sim::BakeReader bake(folder / "a.bake");
  EXPECT_EQ(bake.header().reference_k, 293.15);
  EXPECT_THAT(*bake.header().effects, HasSubstr("kind = \"heat\""));
  const auto live = study::make_live_fluid(order.fluid);
  live->prepare(frames - 1);
  std::vector<float> wanted;
  live->simulation().read_field(sim::ParticleField::Temperature, wanted);
  sim::BakeFrame frame;
  bake.read_frame(frames - 1, frame);
  ASSERT_EQ(frame.temperature_k.size(), wanted.size());
  EXPECT_LT(frame.temperature_error_k, 5e-4);
  for (std::size_t i = 0; i < wanted.size(); ++i)
    ASSERT_NEAR(frame.temperature_k[i], wanted[i], frame.temperature_error_k + 4e-6);
  EXPECT_GT(*std::max_element(wanted.begin(), wanted.end()), 30);
}

TEST(HeatBake, WaterWithoutHeatHoldsNoneAndKeepsItsFormat) {
  const auto header = study::header_of(order_with(false, false, "single_dam"));
  EXPECT_FALSE(header.reference_k);
  EXPECT_EQ(sim::format_of(header), 4u);
  try {
    study::header_of(order_with(true, false, "single_dam"));
    FAIL();
  } catch (const base::Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("has no heat, and so no temperatures to paint"));
  }
}

TEST(HeatBake, TakesTwoBytesMoreAParticle) {
  NEEDS_EFFECTS;
  auto header = study::header_of(order_with(false));
  const auto warm = most_bytes(header);
  header.reference_k.reset();
  EXPECT_EQ(warm - most_bytes(header), 2u * frames * 512);
}

TEST(HeatBakeGl, ItsDescriptionTellsWhatIsPainted) {
  NEEDS_EFFECTS;
  const test::TemporaryFolder folder;
  auto order = order_with(false);
  order.frames = 1;
  study::write_bake(order, study::header_of(order), folder / "a.bake", true, {});
  const std::string words = ", painted temperature 293.15 to 353.15 K";
  EXPECT_THAT(played(folder / "a.bake", true)->description(), EndsWith(words));
  EXPECT_THAT(played(folder / "a.bake", false)->description(), Not(HasSubstr("painted")));
  EXPECT_THAT(study::make_live_fluid(order_with(true).fluid)->description(), EndsWith(words));
  const auto context = sim::GlContext::make_headless();
  auto pictures = order_with(true, true);
  pictures.frames = 1;
  study::write_bake(pictures, study::header_of(pictures), folder / "b.bake", true, {});
  EXPECT_THAT(played(folder / "b.bake", true)->description(), EndsWith("160x90 from view" + words));
  EXPECT_THAT(study::make_live_fluid(order_with(false).fluid)->description(), Not(HasSubstr("painted")));
}

TEST(HeatBake, ThatCannotBePaintedAsWantedIsADeparture) {
  NEEDS_EFFECTS;
  auto old = study::header_of(order_with(false));
  old.reference_k.reset();  // as in bakes of formats before 5
  EXPECT_THAT(study::fluid_departures(old, study::header_of(order_with(true))),
              Contains("no temperatures instead of temperatures to paint (bakes before format 5 kept none)"));
  EXPECT_THAT(study::fluid_departures(old, study::header_of(order_with(false))), IsEmpty());
  EXPECT_THAT(
      study::fluid_departures(study::header_of(order_with(false)), study::header_of(order_with(true))),
      IsEmpty())
      << "the player paints";
  const auto plain = study::header_of(order_with(false, true)),
             painted = study::header_of(order_with(true, true));
  EXPECT_THAT(study::fluid_departures(painted, painted), IsEmpty());
  EXPECT_THAT(study::fluid_departures(plain, painted),
              Contains("pictures with nothing painted over them instead of temperature painted over them"));
  EXPECT_THAT(study::fluid_departures(painted, plain),
              Contains("pictures with temperature painted over them instead of nothing painted over them"));
}

}  // namespace
}  // namespace apps
