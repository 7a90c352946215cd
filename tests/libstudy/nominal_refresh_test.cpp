#include "libstudy/pacing/nominal_refresh.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace study {
namespace {

TEST(NominalRefresh, IsTheUsualRateWithinHalfAPercent) {
  for (const auto& [hz, nominal] : std::vector<std::pair<double, double>>{{59.94, 60},
                                                                          {59.95, 60},
                                                                          {60, 60},
                                                                          {119.88, 120},
                                                                          {143.86, 144},
                                                                          {90.0000009, 90},
                                                                          {71.99, 72},
                                                                          {239.76, 240}})
    EXPECT_EQ(nominal_refresh(hz), nominal) << hz;
}

TEST(NominalRefresh, OfOtherRatesIsTheToldOneOrTheRateItself) {
  EXPECT_EQ(nominal_refresh(76.5), 76.5);
  EXPECT_EQ(nominal_refresh(76.5, 76.6), 76.6);
  EXPECT_EQ(nominal_refresh(143.3, 143), 143) << "a told rate is nearer than a usual one";
  EXPECT_EQ(nominal_refresh(59.94, 59.94), 60) << "also of a rate that is told so";
  EXPECT_EQ(nominal_refresh(144, 60), 144) << "a told rate that is wrong is not believed";
  EXPECT_EQ(nominal_refresh(59.6), 59.6);
}

TEST(NominalRefresh, AMeasuredRateIsTheWholeOneWithin100Ppm) {
  EXPECT_EQ(nominal_refresh(88.0000009), 88);
  EXPECT_EQ(nominal_refresh(88.008, 88), 88);
  EXPECT_EQ(nominal_refresh(88.01), 88.01);
  EXPECT_EQ(nominal_refresh(87.31000001, 87.31), 87.31) << "the only rate that is listed";
}

}  // namespace
}  // namespace study
