/// Temperatures in a bake file; bakes without temperatures keep their bytes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "libsim/bake/bake_file.hpp"
#include "stats/base/file.hpp"
#include "tests/libsim/bake/bake_of_format_4.hpp"

namespace {

using bake_test::error_of;
using bake_test::Folder;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

sim::BakeHeader warm_header(std::int64_t frames, int width = 0, int height = 0) {
  auto header = bake_test::header(frames, width, height);
  header.reference_k = 293.15;
  header.effects = "[[effect]]\nkind = \"heat\"\ndiffusivity_m2_s = 0.001\n";
  return header;
}

/// Temperatures by height, 8 K per metre, so that each particle's can be recognised.
std::vector<float> temperatures_of(const std::vector<sim::RenderParticle>& particles) {
  std::vector<float> out;
  for (const auto& p : particles) out.push_back(8 * p.y_m - 3);
  return out;
}

void write_warm(const std::filesystem::path& path, std::int64_t frames, int width = 0) {
  sim::BakeWriter writer(path, warm_header(frames, width, width / 2), true);
  for (std::int64_t i = 0; i < frames; ++i) {
    const auto particles = bake_test::particles(i);
    writer.add_frame(0.5 * static_cast<double>(i), particles, bake_test::account(i),
                     temperatures_of(particles));
    if (width) writer.add_picture(bake_test::picture(i, width, width / 2));
  }
  writer.finish();
}

TEST(BakeTemperature, ComesBackWithItsParticleWithinTheErrorThatIsTold) {
  const Folder folder;
  for (const int width : {0, 8}) {
    write_warm(folder / "a.bake", 33, width);
    const sim::BakeReader bake(folder / "a.bake");
    EXPECT_EQ(bake.header().reference_k, 293.15);
    sim::PictureReader pictures(bake);
    sim::BakeFrame frame;
    for (const std::int64_t i : {32, 0, 7}) {
      bake.read_frame(i, frame);
      auto wanted = bake_test::particles(i);
      std::stable_sort(wanted.begin(), wanted.end(),
                       [](const auto& a, const auto& b) { return a.radius_m < b.radius_m; });
      const auto kelvin = temperatures_of(wanted);
      ASSERT_EQ(frame.temperature_k.size(), kelvin.size());
      const auto [least, most] = std::minmax_element(kelvin.begin(), kelvin.end());
      EXPECT_NEAR(frame.temperature_error_k, (*most - *least) / 131070, 1e-9);
      EXPECT_LT(frame.temperature_error_k, 5e-4) << "K over some 50 K";
      for (std::size_t k = 0; k < kelvin.size(); ++k)
        ASSERT_NEAR(frame.temperature_k[k], kelvin[k], frame.temperature_error_k + 4e-6) << i;
      EXPECT_EQ(frame.particles[7].radius_m, wanted[7].radius_m);
      if (width) {
        EXPECT_EQ(pictures.read(i).rgba, bake_test::picture(i, width, width / 2));
      }
    }
  }
}

TEST(BakeTemperature, OneFrameMayBeWithoutParticlesOrOfOneTemperature) {
  const Folder folder;
  sim::BakeWriter writer(folder / "a.bake", warm_header(2), true);
  writer.add_frame(0, {}, {}, {});
  writer.add_frame(1, {{1, 2, 3, 0.1F}, {2, 2, 3, 0.1F}}, {}, {60, 60});
  writer.finish();
  const sim::BakeReader bake(folder / "a.bake");
  sim::BakeFrame frame;
  bake.read_frame(1, frame);
  EXPECT_THAT(frame.temperature_k, ::testing::ElementsAre(60, 60));
  EXPECT_EQ(frame.temperature_error_k, 0);
  bake.read_frame(0, frame);
  EXPECT_THAT(frame.temperature_k, IsEmpty());
}

/// The file was written by the version before format 5.
TEST(BakeTemperature, WaterWithoutHeatKeepsFormat4BitForBit) {
  const Folder folder;
  bake_test::write_of_format_4(folder / "a.bake");
  const auto kept = base::resource("tests/libsim/bake/fixtures/format_4.bake");
  EXPECT_EQ(bake_test::read_all(folder / "a.bake"), bake_test::read_all(kept));
  const sim::BakeReader bake(kept);
  EXPECT_FALSE(bake.header().reference_k);
  EXPECT_THAT(bake.header().overlay, IsEmpty());
  sim::BakeFrame frame;
  bake.read_frame(1, frame);
  EXPECT_EQ(frame.particles.size(), 4u);
  EXPECT_EQ(frame.foam.size(), 2u);
  EXPECT_THAT(frame.temperature_k, IsEmpty());
}

TEST(BakeTemperature, OnlyWhatHoldsSomethingNewIsOfFormat5) {
  const Folder folder;
  write_warm(folder / "warm.bake", 1);
  bake_test::write(folder / "cold.bake", 1);
  EXPECT_EQ(bake_test::read_all(folder / "warm.bake")[8], 5);
  EXPECT_EQ(bake_test::read_all(folder / "cold.bake")[8], 4);
  auto unlit = bake_test::header(1);
  EXPECT_EQ(sim::format_of(unlit), 4u);
  unlit.picture_effects = "";
  EXPECT_EQ(sim::format_of(unlit), 5u) << "none is not the scene's own";
}

TEST(BakeTemperature, HeaderComesBackAsWritten) {
  const Folder folder;
  auto header = warm_header(1);
  header.overlay = "temperature";
  header.picture_effects = "[[effect]]\nkind = \"shadows\"\nstrength = 0.5\n";
  sim::BakeWriter writer(folder / "a.bake", header, true);
  writer.add_frame(0, {}, {}, {});
  writer.finish();
  const sim::BakeReader bake(folder / "a.bake");
  EXPECT_EQ(bake.header().overlay, "temperature");
  EXPECT_EQ(bake.header().picture_effects, header.picture_effects);
  EXPECT_EQ(sim::format_bake_header(bake.header()), sim::format_bake_header(header));
}

TEST(BakeSurface, OnlyABakeThatRecordsItIsOfFormat6) {
  const Folder folder;
  auto header = bake_test::header(1, 8, 4);
  EXPECT_EQ(sim::format_of(header), 4u);
  header.view.surface = "spheres";
  ASSERT_EQ(sim::format_of(header), 6u);
  sim::BakeWriter writer(folder / "a.bake", header, true);
  writer.add_frame(0, bake_test::particles(0), bake_test::account(0));
  writer.add_picture(bake_test::picture(0, 8, 4));
  writer.finish();
  EXPECT_EQ(bake_test::read_all(folder / "a.bake")[8], 6);
  const sim::BakeReader bake(folder / "a.bake");
  EXPECT_EQ(bake.header().view.surface, "spheres");
  EXPECT_FALSE(bake.header().reference_k);
  EXPECT_EQ(sim::PictureReader(bake).read(0).rgba, bake_test::picture(0, 8, 4));
}

TEST(BakeSurface, AnUnknownWordAndABakeWithoutAPictureAreRefused) {
  const Folder folder;
  auto header = bake_test::header(1);
  const auto refusal = [&] { return error_of([&] { sim::BakeWriter(folder / "a.bake", header, true); }); };
  header.view.surface = "balls";
  EXPECT_THAT(refusal(), AllOf(HasSubstr("surface is \"balls\""), HasSubstr("ellipsoids or spheres")));
  header.view = {};
  header.view.surface = "spheres";
  EXPECT_THAT(refusal(), HasSubstr("in a bake for which a picture was drawn"));
}

TEST(BakeTemperature, WhatCannotBeKeptIsRefused) {
  const Folder folder;
  sim::BakeWriter writer(folder / "a.bake", warm_header(9), true);
  const auto add = [&](const std::vector<float>& kelvin) {
    return error_of([&] { writer.add_frame(0, {{0, 0, 0, 0.05F}, {1, 0, 0, 0.05F}}, {}, kelvin); });
  };
  EXPECT_THAT(add({0, NAN}), AllOf(HasSubstr("a.bake: frame 0"), HasSubstr("temperature is not finite")));
  // A step of 16 bit over 20,000 K is 0.31 K: more than 0.1 K on each side.
  EXPECT_THAT(add({-10'000, 10'000}), HasSubstr("temperatures span 2e+04 K"));
  EXPECT_EQ(add({-273, 9700}), "") << "all that scenes may name";
  EXPECT_THROW(add({0}), std::logic_error);
  EXPECT_THROW(add({}), std::logic_error);
  sim::BakeWriter cold(folder / "b.bake", bake_test::header(1), true);
  EXPECT_THROW(cold.add_frame(0, {{0, 0, 0, 0.05F}}, {}, {1}), std::logic_error);
}

TEST(BakeTemperature, EveryFlippedBitIsFound) {
  const Folder folder;
  write_warm(folder / "a.bake", 2);
  sim::Bytes bytes = bake_test::read_all(folder / "a.bake");
  const auto read = [&] {
    return error_of([&] {
      const sim::BakeReader bake(bytes, "flipped.bake");
      sim::BakeFrame frame;
      for (const std::int64_t i : {0, 1}) bake.read_frame(i, frame);
    });
  };
  for (std::size_t at = 0; at < bytes.size(); at += 41) {
    const std::size_t from_end = bytes.size() - at;
    if (from_end <= 16 && from_end > 8) continue;  // no check covers the content hash's own bytes
    bytes[at] ^= static_cast<std::uint8_t>(1U << at % 8);
    ASSERT_THAT(read(), HasSubstr("flipped.bake")) << "byte " << at;
    bytes[at] ^= static_cast<std::uint8_t>(1U << at % 8);
  }
  EXPECT_EQ(read(), "");
}

/// Decodes chunks of the wrong size directly, because in a file their checksums would find the damage first.
TEST(BakeTemperature, ChunksOfAnotherSizeThanTheirCountsSayAreRefused) {
  const std::vector<sim::RenderParticle> two{{0, 0, 0, 0.05F}, {1, 0, 0, 0.05F}};
  const std::vector<float> radii{0.05F}, kelvin{1, 2};
  sim::Bytes warm, cold, scratch;
  sim::encode_particles(0, {}, two, radii, &kelvin, 1, "f", warm);
  sim::encode_particles(0, {}, two, radii, nullptr, 1, "f", cold);
  sim::BakeFrame frame;
  const auto error = [&](const sim::Bytes& payload, bool temperatures) {
    return error_of([&] {
      sim::decode_particles(payload, {5, radii, 9, temperatures}, "f", scratch, frame);
    });
  };
  EXPECT_EQ(error(warm, true), "");
  EXPECT_EQ(error(cold, false), "");
  EXPECT_NE(error(warm, false), "");
  EXPECT_NE(error(cold, true), "");
}

}  // namespace
