/// A bake of particles holds the scene's foam, and the player shows it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libsim/gl/offscreen.hpp"
#include "libstudy/stimulus/bakes/write_bake.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::int64_t frames = 61;
constexpr int width = 160, height = 90;

/// The bore of SeaSpray at a coarse size; it has not hit anything yet, but overturns.
study::BakeOrder order_with(std::vector<sim::Effect> effects) {
  study::BakeOrder order;
  order.fluid.scene = base::find_input("data/scenes/sea_spray.toml");
  order.fluid.method = "LoRes";
  order.fluid.n_star = "512";
  order.fluid.backend = "cpu";
  order.fluid.effects = std::move(effects);
  order.frames = frames;
  return order;
}

sim::Effect much_foam() {
  sim::Effect foam{sim::EffectKind::Foam, 3};
  foam.options[static_cast<std::size_t>(sim::EffectOption::FoamMost)] = 8192;
  foam.options[static_cast<std::size_t>(sim::EffectOption::FoamDiameter)] = 0.1;
  return foam;
}

void write(const study::BakeOrder& order, const std::filesystem::path& path) {
  study::write_bake(order, study::header_of(order), path, true, {});
}

std::vector<std::uint8_t> picture_of(study::Stimulus& stimulus, std::int64_t step) {
  const sim::Offscreen target(width, height);
  stimulus.start(0);
  stimulus.prepare(step);
  stimulus.draw({target.framebuffer(), width, height});
  return target.read().rgba;
}

double difference(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(double(a[i]) - double(b[i]));
  return sum / static_cast<double>(a.size());
}

TEST(FoamBakeGl, IsPlayedAsItWasLive) {
  if (!sim::has_effects()) GTEST_SKIP() << "built without effects";
  const test::TemporaryFolder folder;
  write(order_with({much_foam()}), folder / "foam.bake");
  write(order_with({}), folder / "none.bake");
  const sim::BakeReader with(folder / "foam.bake"), without(folder / "none.bake");
  EXPECT_EQ(with.header().max_foam, 8192);
  EXPECT_EQ(without.header().max_foam, 0);
  sim::BakeFrame foamy, bare;
  with.read_frame(frames - 1, foamy);
  without.read_frame(frames - 1, bare);
  ASSERT_GT(foamy.foam.size(), 100u);
  EXPECT_THAT(bare.foam, IsEmpty());
  // Foam does not influence the water.
  ASSERT_EQ(foamy.particles.size(), bare.particles.size());
  EXPECT_EQ(foamy.particles[7].x_m, bare.particles[7].x_m);

  const auto context = sim::GlContext::make_headless();
  const auto live = study::make_live_fluid(order_with({much_foam()}).fluid);
  study::StimulusChoice foam_choice, none_choice;
  foam_choice.bake = folder / "foam.bake";
  none_choice.bake = folder / "none.bake";
  const auto as_live = picture_of(*live, frames - 1);
  const auto as_baked = picture_of(*study::make_stimulus(foam_choice), frames - 1);
  const auto without_foam = picture_of(*study::make_stimulus(none_choice), frames - 1);
  EXPECT_LT(difference(as_live, as_baked), 0.3) << "grey levels of 255";
  EXPECT_GT(difference(without_foam, as_baked), 3 * difference(as_live, as_baked) + 0.3);
}

TEST(FoamBake, ItsHeaderAndDescriptionTellTheEffects) {
  if (!sim::has_effects()) GTEST_SKIP() << "built without effects";
  const test::TemporaryFolder folder;
  auto order = order_with({much_foam()});
  order.frames = 1;
  write(order, folder / "foam.bake");
  study::StimulusChoice choice;
  choice.bake = folder / "foam.bake";
  EXPECT_THAT(study::make_stimulus(choice)->description(), HasSubstr(", effects foam emission_per_s = 3 "));
  order = order_with({});
  order.frames = 1;
  write(order, folder / "none.bake");
  choice.bake = folder / "none.bake";
  EXPECT_THAT(study::make_stimulus(choice)->description(), HasSubstr(", effects none"));
}

TEST(FoamBake, OfOtherEffectsIsADeparture) {
  if (!sim::has_effects()) GTEST_SKIP() << "built without effects";
  const auto wanted = study::header_of(order_with({much_foam()})), none = study::header_of(order_with({}));
  EXPECT_THAT(study::fluid_departures(wanted, wanted), IsEmpty());
  EXPECT_THAT(study::fluid_departures(none, wanted),
              Contains(AllOf(HasSubstr("no effects instead of foam emission_per_s = 3"))));
  EXPECT_THAT(study::fluid_departures(wanted, none), Contains(HasSubstr("instead of no effects")));
}

/// Bakes before format 4 stored no foam. A bake of particles without foam is a different stimulus, but its
/// pictures still show the foam.
TEST(FoamBake, OfAnEarlierFormatLacksTheScenesFoam) {
  if (!sim::has_effects()) GTEST_SKIP() << "built without effects";
  const sim::BakeReader old(base::resource("tests/libsim/bake/fixtures/format_3.bake"));
  study::BakeOrder order = order_with({});
  order.fluid.effects.reset();
  order.fluid.n_star = "64";
  order.frames = 3;
  auto found = old.header(), wanted = study::header_of(order);
  wanted.scene_sha256 = found.scene_sha256;  // the scene's file may have changed since
  wanted.scene_text = found.scene_text;
  EXPECT_THAT(study::fluid_departures(found, wanted),
              Contains(HasSubstr("no particles of foam instead of foam (bakes before format 4 kept none)")));
  found.picture_width_px = found.picture_height_px = 64;
  EXPECT_THAT(study::fluid_departures(found, wanted), IsEmpty());
}

}  // namespace
}  // namespace apps
