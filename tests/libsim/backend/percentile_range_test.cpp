/// The range between two percentiles by which temporal acceleration normalises the importance of particles.

#include <algorithm>
#include <random>
#include <vector>

#include "libsim/activation/percentile_range.hpp"
#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {
namespace {

struct Count {
  const float* values;
  ValueCounter counter;
  SIM_FN void operator()(int i) const { counter.add(i, values[i]); }
};

void follow(PercentileRange& range, const Array<float>& values, int n, float share) {
  for_each("count", n, Count{values.data(), range.counter()});
  range.follow_percentiles(n, share);
}

SIM_TEST(PercentileRange, FindsPercentilesAndIsNotMovedByAnOutlier) {
  std::mt19937 random(1);
  std::vector<float> values;
  for (int i = 1; i <= 10000; ++i) values.push_back(static_cast<float>(i) / 100);
  std::shuffle(values.begin(), values.end(), random);
  Array<float> device;
  device.from_host(values);
  PercentileRange range;
  follow(range, device, 10000, 0.1f);
  EXPECT_NEAR(range.read().low, 1, 0.1);
  EXPECT_NEAR(range.read().high, 99, 9);
  const ValueRange first = range.read();
  values[7] = 1e9f;
  device.from_host(values);
  follow(range, device, 10000, 1);
  EXPECT_NEAR(range.read().high, first.high, 0.01f * first.high);
  range.take_extremes(device, 10000);
  EXPECT_EQ(range.read().low, 0.01f);
  EXPECT_EQ(range.read().high, 1e9f);
}

SIM_TEST(PercentileRange, MovesATenthOfTheWayAndTakesNoWidthAsOne) {
  Array<float> device;
  device.from_host(std::vector<float>(100, 4));
  PercentileRange range;
  follow(range, device, 0, 0.1f);
  follow(range, device, 100, 0.1f);
  const ValueRange first = range.read();
  device.from_host(std::vector<float>(100, 1024));
  follow(range, device, 100, 0.1f);
  const ValueRange second = range.read();
  follow(range, device, 100, 1);
  const ValueRange there = range.read();
  EXPECT_NEAR(second.high, first.high + 0.1f * (there.high - first.high), 1e-3f);
  EXPECT_EQ((ValueRange{3, 3}.normalised(3)), 1);
  EXPECT_EQ((ValueRange{3, 5}.normalised(4)), 0.5f);
  EXPECT_EQ((ValueRange{3, 5}.normalised(9)), 1);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
