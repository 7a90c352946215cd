#pragma once
/// Sums in the back end's memory, added in the same order in every run.

#include "libsim/exec/one_block.hpp"

namespace sim::SIM_BACKEND {

namespace ordered_sum_detail {

/// Number of terms that a team adds.
constexpr int run_length = 64;
/// Number of partial sums that a block computes in parallel.
constexpr int rows = 128;

template <class F>
struct AddRun {
  F f;
  int n;
  float* sums;
  template <class Team>
  SIM_FN void operator()(int run, Team team) const {
    const int end = (run + 1) * run_length < n ? (run + 1) * run_length : n;
    float sum = 0;
    for (int i = run * run_length + team.rank(); i < end; i += Team::size) sum += f(i);
    sum = team.sum(sum);
    if (team.rank() == 0) sums[run] = sum;
  }
};

struct AddRow {
  const float* sums;
  int count;
  float* out;
  SIM_FN void operator()(int row) const {
    float sum = 0;
    for (int k = row; k < count; k += rows) sum += sums[k];
    out[row] = sum;
  }
};

template <class Take>
struct TakeRows {
  const float* sums;
  Take take;
  SIM_FN void operator()(int) const {
    float sum = 0;
    for (int row = 0; row < rows; ++row) sum += sums[row];
    take(sum);
  }
};

template <class Take>
struct AddRuns {
  const float* sums;
  int count;
  Take take;
  template <class Block>
  SIM_FN void operator()(Block block, unsigned char* room) const {
    float* const in_rows = reinterpret_cast<float*>(room);
    block.each(rows, AddRow{sums, count, in_rows});
    block.each(1, TakeRows<Take>{in_rows, take});
  }
};

}  // namespace ordered_sum_detail

/// Computes sums in a fixed order; its memory is allocated at the first sum.
class OrderedSum {
 public:
  /// Calls take(f(0) + ... + f(n-1)) once, on the device. f(i) may also write data of index i. `most`: memory
  /// is allocated for sums of up to this many terms.
  template <class F, class Take>
  void operator()(const char* label, int n, int most, F f, Take take) {
    using namespace ordered_sum_detail;
    const auto runs = [](int count) { return (count + run_length - 1) / run_length; };
    sums_.reserve(static_cast<std::size_t>(runs(most)));
    for_each_team(label, runs(n), AddRun<F>{f, n, sums_.data()});
    in_one_block("add runs", rows, rows * sizeof(float), room_, AddRuns<Take>{sums_.data(), runs(n), take});
  }

 private:
  Array<float> sums_;
  Array<unsigned char> room_;
};

}  // namespace sim::SIM_BACKEND
