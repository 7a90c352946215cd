/// Counts in bins, and the search for the bin that holds a rank.

#include "libsim/exec/histogram.hpp"

#include <algorithm>
#include <random>

#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {
namespace {

constexpr int bins = 1024;

struct CountAll {
  const int* bin;
  Histogram histogram;
  SIM_FN void operator()(int i) const { histogram.add(i, bin[i], 1); }
};

struct Found {
  int bin, before, count;
};

/// Finds the bin of a rank. Ranks are counted from the first bin of run `from`; a run is a group of
/// consecutive bins.
struct FindRank {
  int from, rank;
  Found* out;
  template <class Block>
  SIM_FN void operator()(Block block, const BinCounts& counts) const {
    block.each(counts.runs(), Look{counts, from, rank, out});
  }
  struct Look {
    BinCounts counts;
    int from, rank;
    Found* out;
    SIM_FN void operator()(int at) const {
      counts.find(at, from, rank, [&](int bin, int before, int count) { *out = {bin, before, count}; });
    }
  };
};

SIM_TEST(Histogram, FindsTheBinOfEachRankAndIsEmptyAfterwards) {
  std::mt19937 random(1);
  std::vector<int> values;
  // One bin holds a thousand values or more; four bins of five are empty.
  for (int i = 0; i < 3000; ++i)
    values.push_back(i % 3 == 0 ? 700 : static_cast<int>(random() % bins) / 5 * 5);
  Array<int> device;
  device.from_host(values);
  std::sort(values.begin(), values.end());
  Array<Found> found(1);
  HistogramStore store;
  for (const int from : {0, 32}) {
    const auto first = std::lower_bound(values.begin(), values.end(), from * BinCounts::run);
    const auto size = static_cast<int>(values.end() - first);
    for (const int rank : {0, 1, size / 2, size - 1}) {
      for_each("count", 3000, CountAll{device.data(), store.view(bins)});
      store.take("find", bins, FindRank{from, rank, found.data()});
      const Found out = found.to_host()[0];
      const int value = *(first + rank);
      const auto equal = std::equal_range(first, values.end(), value);
      EXPECT_EQ(out.bin, value) << from << " " << rank;
      EXPECT_EQ(out.before, equal.first - first) << from << " " << rank;
      EXPECT_EQ(out.count, equal.second - equal.first) << from << " " << rank;
    }
  }
  found.from_host({{-1, -1, -1}});
  store.take("find", bins, FindRank{0, 0, found.data()});
  EXPECT_EQ(found.to_host()[0].bin, -1) << "nothing was counted since";
}

}  // namespace
}  // namespace sim::SIM_BACKEND
