/// Foam and effects in a bake file, and files of format 3, which has neither.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libsim/bake/bake_file.hpp"
#include "stats/base/file.hpp"
#include "tests/libsim/bake/make_bake.hpp"

namespace {

using bake_test::error_of;
using bake_test::Folder;
using ::testing::HasSubstr;

/// The file was written by the version before format 4: SeaSpray, whose scene lists foam.
TEST(BakeFoam, Format3IsReadAndKeepsNoFoam) {
  const sim::BakeReader bake(base::resource("tests/libsim/bake/fixtures/format_3.bake"));
  EXPECT_FALSE(bake.header().effects);
  EXPECT_EQ(bake.header().max_foam, 0);
  EXPECT_EQ(bake.header().view.gaze, "none");
  if (sim::has_effects()) {
    EXPECT_EQ(sim::baked_scene(bake.header()).effects.at(0).kind, sim::EffectKind::Foam);
  }
  sim::BakeFrame frame;
  bake.read_frame(2, frame);
  EXPECT_EQ(frame.particles.size(), 64u);
  EXPECT_TRUE(frame.foam.empty());
}

std::vector<sim::RenderParticle> foam_of(std::int64_t frame) {
  std::vector<sim::RenderParticle> out = bake_test::particles(frame, 3, 2, static_cast<int>(frame));
  for (std::size_t i = 0; i < out.size(); ++i) out[i].radius_m = 0.01F + 0.0001F * static_cast<float>(i);
  return out;
}

/// Frame i has 6 i foam particles; `pictures`: adds pictures 8 px wide.
void write_foam(const std::filesystem::path& path, std::int64_t frames, bool pictures) {
  auto header = bake_test::header(frames, pictures ? 8 : 0, pictures ? 4 : 0);
  header.max_foam = 1000;
  header.effects = "[[effect]]\nkind = \"foam\"\nemission_per_s = 2\n";
  sim::BakeWriter writer(path, header, true);
  for (std::int64_t i = 0; i < frames; ++i) {
    writer.add_frame(0.5 * static_cast<double>(i), bake_test::particles(i), bake_test::account(i));
    writer.add_foam(foam_of(i));
    if (pictures) writer.add_picture(bake_test::picture(i, 8, 4));
  }
  writer.finish();
}

TEST(BakeFoam, FoamComesBackWithItsFrame) {
  const Folder folder;
  for (const bool pictures : {false, true}) {
    write_foam(folder / "a.bake", 33, pictures);
    const sim::BakeReader bake(folder / "a.bake");
    EXPECT_EQ(bake.header().max_foam, 1000);
    ASSERT_TRUE(bake.header().effects);
    sim::PictureReader reader(bake);
    sim::BakeFrame frame;
    for (const std::int64_t i : {32, 0, 7}) {
      bake.read_frame(i, frame);
      const auto wanted = foam_of(i);
      ASSERT_EQ(frame.foam.size(), wanted.size());
      for (std::size_t k = 0; k < wanted.size(); ++k) {
        EXPECT_NEAR(frame.foam[k].x_m, wanted[k].x_m, 20.0 / 131070);
        EXPECT_NEAR(frame.foam[k].z_m, wanted[k].z_m, 20.0 / 131070);
        EXPECT_NEAR(frame.foam[k].radius_m, wanted[k].radius_m, 1e-6);
      }
      EXPECT_EQ(frame.particles.size(), 960u);
      if (pictures) {
        EXPECT_EQ(reader.read(i).rgba, bake_test::picture(i, 8, 4));
      }
    }
  }
}

TEST(BakeFoam, DamagedFoamIsRefused) {
  const auto error_with = [](const auto& change) {
    auto foam = foam_of(4);
    change(foam);
    return error_of([&] {
      sim::Bytes bytes, scratch;
      sim::encode_foam(foam, 1, "f", bytes);
      sim::decode_foam(bytes, 24, "f", scratch, foam);
    });
  };
  using Foam = std::vector<sim::RenderParticle>;
  EXPECT_EQ(error_with([](Foam&) {}), "");
  EXPECT_EQ(error_with([](Foam& foam) { foam.clear(); }), "");
  EXPECT_THAT(error_with([](Foam& foam) { foam.push_back(foam[0]); }),
              HasSubstr("states 25 particles of foam"));
  EXPECT_THAT(error_with([](Foam& foam) { foam[3].y_m = NAN; }), HasSubstr("radius is not above 0"));
  EXPECT_THAT(error_with([](Foam& foam) { foam[3].radius_m = 0; }), HasSubstr("radius is not above 0"));
}

TEST(BakeFoam, AFrameWithoutItsFoamIsNotWritten) {
  const Folder folder;
  auto header = bake_test::header(2);
  header.max_foam = 10;
  sim::BakeWriter writer(folder / "a.bake", header, true);
  EXPECT_THROW(writer.add_foam({}), std::logic_error);
  writer.add_frame(0, bake_test::particles(0), {});
  EXPECT_THROW(writer.add_frame(1, bake_test::particles(1), {}), std::logic_error);
  EXPECT_THAT(error_of([&] { writer.add_foam(foam_of(2)); }),
              HasSubstr("more foam than max_foam of the header"));
  writer.add_foam({});
  EXPECT_THROW(writer.add_foam({}), std::logic_error);
}

}  // namespace
