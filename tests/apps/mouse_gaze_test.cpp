#include "libstudy/pages/mouse_gaze.hpp"

#include <gtest/gtest.h>

namespace {

using study::GazePoint;

struct Mouse {
  study::VirtualClock clock;
  study::MouseGaze::Place place = GazePoint{0.5, 0.25};
  study::MouseGaze gaze{[this] { return place; }, clock};
};

TEST(MouseGaze, TellsWhereItIsAtTheStartAndEachMove) {
  Mouse mouse;
  mouse.clock.wait_until(100);
  mouse.gaze.start();
  mouse.clock.wait_until(200);
  mouse.gaze.moved(GazePoint{0, 0.999});
  const auto samples = mouse.gaze.take();
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(mouse.gaze.origin(), study::GazeOrigin::Mouse);
  EXPECT_EQ(samples[0].sampled_ns, 100);
  EXPECT_EQ(samples[0].point, mouse.place);
  EXPECT_EQ(samples[1].sampled_ns, 200);
  EXPECT_EQ(samples[1].point, (GazePoint{0, 0.999}));
  EXPECT_TRUE(samples[0].valid && samples[1].valid);
  EXPECT_FALSE(samples[0].device_ns || samples[1].device_ns);
  EXPECT_TRUE(mouse.gaze.take().empty());
}

TEST(MouseGaze, IsNotValidOffThePicture) {
  Mouse mouse;
  mouse.place = {};
  mouse.gaze.start();
  for (const GazePoint& beside : {GazePoint{1, 0.5}, GazePoint{0.5, 1}, GazePoint{-0.1, 0.5}})
    mouse.gaze.moved(beside);
  const auto samples = mouse.gaze.take();
  ASSERT_EQ(samples.size(), 4u);
  for (const auto& sample : samples) {
    EXPECT_FALSE(sample.valid);
    EXPECT_FALSE(sample.point);
  }
}

TEST(MouseGaze, GathersNothingBetweenStopAndStart) {
  Mouse mouse;
  mouse.gaze.moved(GazePoint{0.1, 0.1});
  EXPECT_TRUE(mouse.gaze.take().empty());
  mouse.gaze.start();
  mouse.gaze.stop();
  mouse.gaze.moved(GazePoint{0.2, 0.2});
  EXPECT_TRUE(mouse.gaze.take().empty());
  mouse.gaze.start();
  EXPECT_EQ(mouse.gaze.take().size(), 1u);
}

}  // namespace
