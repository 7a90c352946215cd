#include "libsim/exec/space.hpp"

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {
namespace {

void expect_sorted_like_std(std::vector<std::uint64_t> keys) {
  std::vector<int> expected(keys.size());
  std::iota(expected.begin(), expected.end(), 0);
  std::stable_sort(expected.begin(), expected.end(), [&](int a, int b) {
    return keys[static_cast<std::size_t>(a)] < keys[static_cast<std::size_t>(b)];
  });
  std::vector<int> iota(keys.size());
  std::iota(iota.begin(), iota.end(), 0);
  Array<std::uint64_t> device_keys;
  Array<int> order;
  device_keys.from_host(keys);
  order.from_host(iota);
  Sorter sorter;
  sorter.sort(device_keys, order);
  EXPECT_EQ(order.to_host(), expected);
  std::sort(keys.begin(), keys.end());
  EXPECT_EQ(device_keys.to_host(), keys);
}

SIM_TEST(Sorter, SortsStablyLikeTheStandardLibrary) {
  std::mt19937_64 random(1);
  for (const std::size_t n : {1u, 2u, 1000u, 70000u}) {
    std::vector<std::uint64_t> keys(n);
    for (auto& key : keys) key = random();
    expect_sorted_like_std(keys);
    for (auto& key : keys) key = random() % 17 << 44 | random() % 5;
    expect_sorted_like_std(keys);
    expect_sorted_like_std(std::vector<std::uint64_t>(n, 42));
  }
}

SIM_TEST(Scanner, SumsInclusively) {
  std::vector<int> values(5000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<int>(i % 7);
  Array<int> device;
  Array<int> sums;
  device.from_host(values);
  Scanner().inclusive_sum(device, sums);
  std::partial_sum(values.begin(), values.end(), values.begin());
  EXPECT_EQ(sums.to_host(), values);
}

SIM_TEST(FixedOrderSum, IsExactWhereDoubleIs) {
  std::vector<float> values(100001, 0.25f);
  Array<float> device;
  device.from_host(values);
  EXPECT_EQ(fixed_order_sum(device, static_cast<int>(values.size())), 100001 * 0.25);
  EXPECT_EQ(fixed_order_sum(device, 0), 0);
}

struct Square {
  int* out;
  SIM_FN void operator()(int i) const { out[i] = i * i; }
};

SIM_TEST(ForEach, VisitsEveryIndexOnceAndNothingWhenEmpty) {
  for_each("nothing", 0, Square{nullptr});
  Array<int> out(3001);
  out.zero();
  for_each("square", 3001, Square{out.data()});
  const auto values = out.to_host();
  for (int i = 0; i < 3001; ++i) ASSERT_EQ(values[static_cast<std::size_t>(i)], i * i);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
