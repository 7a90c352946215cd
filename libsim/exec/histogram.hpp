#pragma once
/// Histograms on the device: counts per bin, and the bin that contains a given rank. They give percentiles
/// without a sort, independent of the order of the values.

#include "libsim/exec/one_block.hpp"

namespace sim::SIM_BACKEND {

/// Counters in the form that kernels use. There are several sets of counters, so that fewer threads contend
/// for one counter.
struct Histogram {
  static constexpr int copies = 8;
  int* counts;
  int bins;

  /// `i`: index of the value, which selects a set.
  SIM_FN void add(int i, int bin, int amount) const {
    atomic_add(&counts[i / 32 % copies * bins + bin], amount);
  }
};

/// A histogram's counts in a block's scratch memory: per bin, per run of 16 bins and per run of 256 bins.
class BinCounts {
 public:
  static constexpr int run = 16;
  /// `bins`: a multiple of 256.
  static constexpr std::size_t bytes(int bins) {
    return sizeof(int) * static_cast<std::size_t>(bins + bins / run + bins / (run * run));
  }
  SIM_FN BinCounts(unsigned char* room, int bins)
      : bins_(bins),
        count_(reinterpret_cast<int*>(room)),
        in_run_(count_ + bins),
        in_long_run_(in_run_ + bins / run) {}

  SIM_FN int runs() const { return bins_ / run; }

  /// Adds up the histogram's sets of counters, and resets these to zero.
  template <class Block>
  SIM_FN void take(Block block, const Histogram& from) const {
    block.each(bins_, AddCopies{from, count_});
    block.each(runs(), AddRun{count_, in_run_});
    block.each(runs() / run, AddRun{in_run_, in_long_run_});
  }

  /// Number of values in the runs before run `at`.
  SIM_FN int before(int at) const {
    int sum = 0;
    for (int k = 0; k < at / run; ++k) sum += in_long_run_[k];
    for (int k = at / run * run; k < at; ++k) sum += in_run_[k];
    return sum;
  }

  /// Finds the value of rank `rank`, counted from the start of run `from`. If it lies in run `at`, calls
  /// found(its bin, number of values between the start of run `from` and the bin, number of values in the
  /// bin).
  template <class Found>
  SIM_FN void find(int at, int from, int rank, Found found) const {
    int below = before(at) - before(from);
    if (rank < below || rank >= below + in_run_[at]) return;
    int bin = at * run;
    for (; rank >= below + count_[bin]; ++bin) below += count_[bin];
    found(bin, below, count_[bin]);
  }

 private:
  struct AddCopies {
    Histogram from;
    int* to;
    SIM_FN void operator()(int b) const {
      int sum = 0;
      for (int c = 0; c < Histogram::copies; ++c) {
        int& count = from.counts[c * from.bins + b];
        sum += count;
        count = 0;
      }
      to[b] = sum;
    }
  };
  struct AddRun {
    const int* from;
    int* to;
    SIM_FN void operator()(int at) const {
      int sum = 0;
      for (int k = 0; k < run; ++k) sum += from[at * run + k];
      to[at] = sum;
    }
  };

  int bins_;
  int* count_;
  int* in_run_;
  int* in_long_run_;
};

/// Calls f(block, counts) with the counts of a histogram.
template <class F>
struct TakeCounts {
  Histogram histogram;
  F f;
  template <class Block>
  SIM_FN void operator()(Block block, unsigned char* room) const {
    const BinCounts counts(room, histogram.bins);
    counts.take(block, histogram);
    f(block, counts);
  }
};

/// Owns the memory of a histogram's counters. take() resets them to zero.
class HistogramStore {
 public:
  Histogram view(int bins) {
    const auto size = static_cast<std::size_t>(Histogram::copies * bins);
    if (counts_.size() != size) {
      counts_.resize(size);
      counts_.zero();
    }
    return {counts_.data(), bins};
  }
  /// Calls f(block, BinCounts) in one block of threads, with the counts since the last call, and resets the
  /// counters to zero. On the GPU each thread of the block makes the call.
  template <class F>
  void take(const char* label, int bins, F f) {
    in_one_block(label, bins, BinCounts::bytes(bins), room_, TakeCounts<F>{view(bins), f});
  }

 private:
  Array<int> counts_;
  Array<unsigned char> room_;
};

}  // namespace sim::SIM_BACKEND
