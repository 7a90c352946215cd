#include "libsim/bake/picture_ring.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "libsim/bake/layout.hpp"
#include "tests/libsim/bake/make_bake.hpp"

namespace {

constexpr int width = 32, height = 18, frames = 70;

class PictureRingTest : public ::testing::Test {
 protected:
  PictureRingTest() { bake_test::write(folder_ / "a.bake", frames, width, height); }
  void expect(sim::PictureRing& ring, std::int64_t frame) {
    ASSERT_EQ(ring.take(frame).rgba, bake_test::picture(frame, width, height)) << frame;
  }
  bake_test::Folder folder_;
};

TEST_F(PictureRingTest, GivesEveryPictureInOrderAndLoopsToTheStart) {
  const sim::BakeReader bake(folder_ / "a.bake");
  sim::PictureRing ring(bake, 4);
  ring.start(13);
  for (int round = 0; round < 3; ++round) {
    for (int i = 13; i < frames; ++i) ASSERT_NO_FATAL_FAILURE(expect(ring, i));
  }
}

TEST_F(PictureRingTest, StartWhereItLoopsGoesOnWithoutANewRound) {
  const sim::BakeReader bake(folder_ / "a.bake");
  sim::PictureRing ring(bake, 4);
  ring.start(60);
  for (int round = 0; round < 3; ++round) {
    for (int i = 60; i < frames; ++i) ASSERT_NO_FATAL_FAILURE(expect(ring, i));
    ring.start(60);
  }
  ring.start(2);
  ASSERT_NO_FATAL_FAILURE(expect(ring, 2));
}

TEST_F(PictureRingTest, RewindsJumpsAndHolds) {
  const sim::BakeReader bake(folder_ / "a.bake");
  sim::PictureRing ring(bake, 5);
  ring.start(0);
  for (const int i : {0, 1, 2, 2, 2, 6, 40, 41, 3, 69, 0, 1, 69, 69, 68}) {
    ASSERT_NO_FATAL_FAILURE(expect(ring, i));
  }
  for (const int start : {64, 0, 31, 31}) {
    ring.start(start);
    for (int i = start; i < frames && i < start + 10; ++i) ASSERT_NO_FATAL_FAILURE(expect(ring, i));
  }
}

TEST_F(PictureRingTest, StaysRightUnderLoad) {
  const sim::BakeReader bake(folder_ / "a.bake");
  std::atomic<bool> stop = false;
  std::vector<std::thread> load;
  for (int i = 0; i < 4; ++i) {
    load.emplace_back([&] {
      volatile unsigned x = 0;
      while (!stop) x = x * 7 + 1;
    });
  }
  sim::PictureRing ring(bake, 3);
  ring.start(0);
  for (int i = 0; i < 3 * frames; ++i) expect(ring, i % frames);
  stop = true;
  for (std::thread& thread : load) thread.join();
}

TEST_F(PictureRingTest, DamagedPictureIsToldAtItsFrame) {
  sim::Bytes bytes = bake_test::read_all(folder_ / "a.bake");
  const std::size_t last = bytes.size() - sim::bake::footer_bytes - 2 * frames * sim::bake::entry_bytes - 1;
  bytes[last] ^= 1;
  const sim::BakeReader bake(bytes, "x.bake");
  sim::PictureRing ring(bake, 4);
  ring.start(frames - 8);
  for (int i = frames - 8; i < frames - 1; ++i) ASSERT_NO_FATAL_FAILURE(expect(ring, i));
  try {
    ring.take(frames - 1);
    FAIL() << "a damaged picture was shown";
  } catch (const base::Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("x.bake: picture 69: does not match"));
  }
}

}  // namespace
