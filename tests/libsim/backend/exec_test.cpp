#include "libsim/exec/one_block.hpp"
#include "libsim/exec/passes.hpp"

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

SIM_TEST(Scanner, CountsWhatIsNotZeroInclusively) {
  Scanner scanner;
  for (const std::size_t n : {0u, 1u, 5000u, 70000u}) {
    std::vector<std::uint8_t> flags(n);
    std::vector<int> expected(n);
    int count = 0;
    for (std::size_t i = 0; i < n; ++i) {
      flags[i] = static_cast<std::uint8_t>(i % 3 == 1 ? 0 : i % 256);
      expected[i] = count += flags[i] != 0;
    }
    Array<std::uint8_t> device;
    Array<int> counts;
    device.from_host(flags);
    scanner.inclusive_count(device.data(), static_cast<int>(n), counts);
    EXPECT_EQ(counts.to_host(), expected) << n;
  }
}

struct AddTo {
  int* to;
  int step;
  SIM_FN void operator()(int i) const { to[i] += step * (i + 1); }
};

SIM_TEST(Passes, EachIndexOfEachOnceInOneLaunch) {
  std::vector<Array<int>> out(4);
  for (auto& part : out) {
    part.resize(1000);
    part.zero();
  }
  const auto part = [&](std::size_t k, int n) {
    return Pass<AddTo>{n, {out[k].data(), static_cast<int>(k) + 1}};
  };
  profile_launches(true);
  for_each_pass("parts", part(0, 700), part(1, 0), part(2, 1), part(3, 1000));
  for_each_pass("none", part(0, 0), part(1, 0));
  const auto times = launch_times();
  profile_launches(false);
  ASSERT_EQ(times.size(), 1u);
  EXPECT_EQ(times[0].launches, 1);
  const int sizes[] = {700, 0, 1, 1000};
  for (std::size_t k = 0; k < 4; ++k) {
    std::vector<int> expected(1000, 0);
    for (int i = 0; i < sizes[k]; ++i)
      expected[static_cast<std::size_t>(i)] = (static_cast<int>(k) + 1) * (i + 1);
    EXPECT_EQ(out[k].to_host(), expected) << k;
  }
}

/// The team's lanes add 0 ... i % 50 and list the odd numbers in order.
struct SumOdd {
  int* sums;
  int* last_place;
  template <class Team>
  SIM_FN void operator()(int i, Team team) const {
    const int steps = i % 50;
    int sum = 0;
    int found = 0;
    int own_place = -1;
    for (int first = 0; first <= steps; first += Team::size) {
      const int k = first + team.rank();
      const bool odd = k <= steps && k % 2 == 1;
      if (k <= steps) sum += k;
      int all;
      const int place = found + team.offset(odd, all);
      if (odd) own_place = place;
      found += all;
    }
    // One lane holds the last odd number, 2 place + 1.
    const bool last = own_place >= 0 && own_place == found - 1;
    const int total = team.sum(sum);
    const int place = team.sum(last ? own_place : 0);
    if (team.rank() > 0) return;
    sums[i] = total;
    last_place[i] = place;
  }
};

SIM_TEST(ForEachTeam, SumsAndCountsForEverySizeOfTeam) {
  // On a device teams have fewer lanes for larger n: eight, four, two or one for these sizes.
  for (const int n : {1, 1000, 100'003, 200'001, 700'003}) {
    Array<int> sums(static_cast<std::size_t>(n));
    Array<int> places(static_cast<std::size_t>(n));
    for_each_team("test", n, SumOdd{sums.data(), places.data()});
    const auto sum = sums.to_host();
    const auto place = places.to_host();
    int wrong = 0;
    for (int i = 0; i < n; ++i) {
      const int steps = i % 50;
      const auto at = static_cast<std::size_t>(i);
      wrong += sum[at] != steps * (steps + 1) / 2 || place[at] != std::max((steps + 1) / 2 - 1, 0);
    }
    EXPECT_EQ(wrong, 0) << n;
  }
}

/// Numbers that repeat, k -> k * 7 % 5, with their place.
struct Ranked {
  int value, place;
  SIM_FN bool before(const Ranked& other) const {
    return value < other.value || (value == other.value && place < other.place);
  }
};

/// The least of the first i % 50 numbers, the place of its first occurrence, and whether any number is 4.
struct FindLeast {
  int* least;
  int* place;
  int* any;
  template <class Team>
  SIM_FN void operator()(int i, Team team) const {
    int smallest = 5;
    Ranked first{5, -1};
    bool four = false;
    for (int k = team.rank(); k < i % 50; k += Team::size) {
      const Ranked next{k * 7 % 5, k};
      smallest = next.value < smallest ? next.value : smallest;
      if (next.before(first)) first = next;
      four = four || next.value == 4;
    }
    smallest = team.min(smallest);
    first = team.first(first);
    four = team.any(four);
    if (team.rank() > 0) return;
    least[i] = smallest;
    place[i] = first.place;
    any[i] = four;
  }
};

SIM_TEST(ForEachTeam, FindsTheLeastAndTheFirstOfEqualsForEverySizeOfTeam) {
  for (const int n : {1, 1000, 100'003, 200'001, 700'003}) {
    const auto size = static_cast<std::size_t>(n);
    Array<int> least(size);
    Array<int> place(size);
    Array<int> any(size);
    for_each_team("test", n, FindLeast{least.data(), place.data(), any.data()});
    const auto leasts = least.to_host();
    const auto places = place.to_host();
    const auto anys = any.to_host();
    int wrong = 0;
    for (int i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const int count = i % 50;
      // The numbers are 0, 2, 4, 1, 3, repeated.
      wrong +=
          leasts[at] != (count > 0 ? 0 : 5) || places[at] != (count > 0 ? 0 : -1) || anys[at] != (count > 2);
    }
    EXPECT_EQ(wrong, 0) << n;
  }
}

struct Fill {
  int* values;
  int value;
  SIM_FN void operator()(int i) const { values[i] = value + i; }
};
/// Each step reads what other threads wrote in the step before; one warp runs the middle steps.
struct Rotate {
  int* out;
  int n;
  template <class Block>
  SIM_FN void operator()(Block block, unsigned char* room) const {
    int* const a = reinterpret_cast<int*>(room);
    int* const b = a + n;
    block.each(n, Fill{a, 0});
    turn(block, a, b);
    block.by_one_warp([&](auto warp) {
      turn(warp, a, b);
      turn(warp, a, b);
    });
    turn(block, a, b);
    block.spread(n, Shift{a, out, n});
  }
  template <class Threads>
  SIM_FN void turn(Threads threads, int* a, int* b) const {
    threads.each(n, Shift{a, b, n});
    threads.each(n, Shift{b, a, n});
  }
  struct Shift {
    const int* from;
    int* to;
    int n;
    SIM_FN void operator()(int i) const { to[i] = from[(i + 1) % n]; }
  };
};

/// The sum and the least of n values by all threads of a warp; each thread writes its result.
struct OfWarp {
  struct Value {
    int n;
    SIM_FN float operator()(int i) const { return static_cast<float>((i * 7 + 3) % n); }
  };
  struct Found {
    float sum, least;
    int where;
  };
  struct Write {
    Found* to;
    Found found;
    SIM_FN void operator()(int i) const { to[i] = found; }
  };
  struct Search {
    Found* to;
    int n;
    float most;
    template <class Threads>
    SIM_FN void operator()(Threads threads) const {
      Found found{};
      found.sum = threads.sum(n, Value{n});
      found.least = threads.least(n, most, found.where, Value{n});
      threads.each(32, Write{to, found});
    }
  };
  Found* to;
  int n;
  float most;
  template <class Block>
  SIM_FN void operator()(Block block, unsigned char* /*room*/) const {
    block.by_one_warp(Search{to, n, most});
  }
};

SIM_TEST(InOneBlock, AllOfAWarpKnowTheSumAndTheLeast) {
  Array<unsigned char> spare;
  Array<OfWarp::Found> out(32);
  for (const int n : {1, 5, 32, 33, 500}) {
    for (const float most : {0.0f, 1.0f, 1e9f}) {
      in_one_block("test", 256, 0, spare, OfWarp{out.data(), n, most});
      float sum = 0, least = most;
      int where = n;
      for (int i = 0; i < n; ++i) {
        const float it = OfWarp::Value{n}(i);
        sum += it;
        if (it < least) where = i;
        least = std::min(it, least);
      }
      for (const OfWarp::Found& found : out.to_host()) {
        EXPECT_EQ(found.sum, sum) << n;
        EXPECT_EQ(found.least, least) << n;
        EXPECT_EQ(found.where, where) << n << ", below " << most;
      }
    }
  }
}

SIM_TEST(InOneBlock, StepsWaitForEachOther) {
  // The last size needs more room than any device has in shared memory.
  Array<unsigned char> spare;
  for (const int n : {1, 700, 5000, 100'000}) {
    const auto size = static_cast<std::size_t>(n);
    Array<int> out(size);
    in_one_block("test", n, 2 * size * sizeof(int), spare, Rotate{out.data(), n});
    const auto values = out.to_host();
    int wrong = 0;
    for (int i = 0; i < n; ++i) wrong += values[static_cast<std::size_t>(i)] != (i + 9) % n;
    EXPECT_EQ(wrong, 0) << n;
  }
}

SIM_TEST(LaunchTimes, TellEachLabelOnlyWhileTheyAreOn) {
  Array<int> values(2000);
  for_each("before", 2000, Fill{values.data(), 1});
  profile_launches(true);
  for_each("within", 2000, Fill{values.data(), 1});
  for_each("within", 2000, Fill{values.data(), 2});
  const auto times = launch_times();
  profile_launches(false);
  for_each("after", 2000, Fill{values.data(), 1});
  ASSERT_EQ(times.size(), 1u);
  EXPECT_EQ(times[0].label, "within");
  EXPECT_EQ(times[0].launches, 2);
  EXPECT_GE(times[0].ms, 0);
  EXPECT_TRUE(launch_times().empty());
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
