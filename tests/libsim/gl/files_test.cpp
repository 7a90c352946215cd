#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <limits>

#include "libsim/gl/png.hpp"
#include "libsim/view/gbuffer.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/common/temporary_folder.hpp"

namespace {

class RenderFiles : public ::testing::Test {
 protected:
  test::TemporaryFolder folder;
};

sim::Image gradient() {
  sim::Image image{5, 3, {}};
  for (int i = 0; i < 60; ++i) image.rgba.push_back(static_cast<std::uint8_t>(4 * i + 3));
  return image;
}

sim::GBuffer small_gbuffer() {
  sim::GBuffer g;
  g.width = 3;
  g.height = 2;
  g.view = sim::make_view(sim::Camera{}, 3, 2);
  g.radius_scale = 1.5F;
  g.depth = {1, 2, 3, 4, 5, std::numeric_limits<float>::infinity()};
  g.filtered_depth = {1.5F, 2, 3, 4, 5, std::numeric_limits<float>::infinity()};
  for (int i = 0; i < 18; ++i) g.normal.push_back(0.1F * static_cast<float>(i));
  g.thickness = {0, 1, 2, 3, 4, 5};
  g.front = {7, 6, 5, 4, 3, sim::GBuffer::no_particle};
  g.radius = {1, 1, 1, 1, 1, 0};
  return g;
}

TEST_F(RenderFiles, PngKeepsEveryByte) {
  sim::write_png(folder / "a.png", gradient());
  const auto back = sim::read_png(folder / "a.png");
  EXPECT_EQ(back.width, 5);
  EXPECT_EQ(back.height, 3);
  EXPECT_EQ(back.rgba, gradient().rgba);
}

TEST_F(RenderFiles, DamagedPngIsNamed) {
  sim::write_png(folder / "a.png", gradient());
  const auto bytes = base::read_file(folder / "a.png", 1 << 20);
  for (const std::size_t kept : {std::size_t{0}, std::size_t{20}, bytes.size() - 20}) {
    base::write_file_atomically(folder / "b.png", std::string_view(bytes).substr(0, kept));
    try {
      sim::read_png(folder / "b.png");
      ADD_FAILURE() << "read " << kept << " bytes";
    } catch (const base::Error& error) {
      EXPECT_NE(std::string(error.what()).find("b.png"), std::string::npos);
    }
  }
  EXPECT_THROW(sim::read_png(folder / "missing.png"), base::Error);
}

TEST_F(RenderFiles, PngThatCannotBeWrittenLeavesTheOldOne) {
  sim::write_png(folder / "a.png", gradient());
  EXPECT_THROW(sim::write_png(folder / "a.png", sim::Image{}), base::Error);
  EXPECT_THROW(sim::write_png(folder / "a.png" / "b.png", gradient()), base::Error);
  EXPECT_EQ(sim::read_png(folder / "a.png").rgba, gradient().rgba);
}

TEST_F(RenderFiles, GBufferKeepsEveryValue) {
  const auto g = small_gbuffer();
  sim::write_gbuffer(folder / "g.bin", g);
  const auto back = sim::read_gbuffer(folder / "g.bin");
  EXPECT_EQ(back.width, 3);
  EXPECT_EQ(back.height, 2);
  EXPECT_EQ(back.view.projection, g.view.projection);
  EXPECT_EQ(back.view.view, g.view.view);
  EXPECT_EQ(back.view.viewport.width, 3);
  EXPECT_EQ(back.view.far_m, g.view.far_m);
  EXPECT_EQ(back.radius_scale, 1.5F);
  EXPECT_EQ(back.depth, g.depth);
  EXPECT_EQ(back.filtered_depth, g.filtered_depth);
  EXPECT_EQ(back.normal, g.normal);
  EXPECT_EQ(back.thickness, g.thickness);
  EXPECT_EQ(back.front, g.front);
  EXPECT_EQ(back.radius, g.radius);
}

TEST_F(RenderFiles, DamagedGBufferIsRefused) {
  sim::write_gbuffer(folder / "g.bin", small_gbuffer());
  const auto bytes = base::read_file(folder / "g.bin", 1 << 20);
  for (const std::size_t kept : {std::size_t{0}, std::size_t{5}, std::size_t{20}, bytes.size() - 1}) {
    base::write_file_atomically(folder / "h.bin", std::string_view(bytes).substr(0, kept));
    EXPECT_THROW(sim::read_gbuffer(folder / "h.bin"), base::Error) << kept;
  }
  base::write_file_atomically(folder / "h.bin", bytes + "x");
  EXPECT_THROW(sim::read_gbuffer(folder / "h.bin"), base::Error);
  auto newer = bytes;
  newer[7] = '2';
  base::write_file_atomically(folder / "h.bin", newer);
  EXPECT_THROW(sim::read_gbuffer(folder / "h.bin"), base::Error);
  auto half = small_gbuffer();
  half.radius.pop_back();
  EXPECT_THROW(sim::write_gbuffer(folder / "i.bin", half), base::Error);
}

}  // namespace
