/// A standing wave in a tank: its period by linear theory, omega^2 = g k tanh k h.

#include <numeric>

#include "tests/truth/truth_helpers.hpp"

namespace {

using namespace truth_test;

/// Period and damping of an oscillation about 0, sampled every dt.
struct Swing {
  double period = 0, damping = 0;  ///< damping: share of the amplitude that is lost per period
  std::size_t crossings = 0;
};
Swing swing_of(const std::vector<double>& s, double dt) {
  std::vector<double> index, crossing, order, peak;
  double high = 0;
  for (std::size_t i = 1; i < s.size(); ++i) {
    high = std::max(high, std::abs(s[i]));
    if ((s[i - 1] < 0) == (s[i] < 0)) continue;
    if (!crossing.empty()) {
      order.push_back(static_cast<double>(order.size()));
      peak.push_back(std::log(high));
    }
    index.push_back(static_cast<double>(index.size()));
    crossing.push_back((static_cast<double>(i) - s[i] / (s[i] - s[i - 1])) * dt);
    high = 0;
  }
  if (crossing.size() < 3) return {};
  return {2 * fit(index, crossing).slope, 1 - std::exp(2 * fit(order, peak).slope), crossing.size()};
}

/// Potential flow under half a wave between two walls, when its surface is flat.
Vec3d flow(const Vec3d& x, double k, double depth, double steepness) {
  const double omega = std::sqrt(gravity * k * std::tanh(k * depth));
  const double u = steepness / k * omega / std::sinh(k * depth);
  return {-u * std::cosh(k * x[1]) * std::sin(k * x[0]), u * std::sinh(k * x[1]) * std::cos(k * x[0]), 0};
}

/// Runs one wave and returns its period and damping. With `gated`, the period must be as in theory.
Swing wave_swings(Run run, const TruthFile& file, std::size_t row, double d, double length, const State& rest,
                  bool gated) {
  const double k = pi / length, depth = d * std::round(file.column("kh")[row] / k / d);
  auto scene = fluid_test::tank({length, 2 * depth, 6 * d}, {});
  const auto start = moving(rest, [&](const Vec3d& x) { return flow(x, k, depth, 0.1); });
  const auto fluid = start_from(run, scene, d, start, inviscid());
  const double theory = file.column("T_sqrt_gk")[row] / std::sqrt(gravity * k);
  std::vector<double> sway;
  while (fluid->frame() * scene.frame_dt_s < 2.4 * theory) {
    fluid->step_frame();
    sway.push_back(mean(fluid->read_state(), [](const auto& p) { return place(p)[0]; }) - length / 2);
  }
  const Swing swing = swing_of(sway, scene.frame_dt_s);
  std::printf(
      "%s, %s, kh %.1f, %.0f spacings long: period off by %+.4f, amplitude lost in a period %.3f; %s\n",
      file.name().c_str(), run.name().c_str(), file.column("kh")[row], length / d, swing.period / theory - 1,
      swing.damping, share(*fluid, start).c_str());
  if (gated)
    expect_within(std::abs(swing.period / theory - 1), file.gate("gate", run.ours()),
                  file.name() + ", " + run.name());
  return swing;
}

/// Runs the first `rows` of each file, in tanks of this many spacings. Returns the shares of the amplitude
/// that were lost per period. With `gated`, the periods must be as in theory.
std::vector<double> waves_swing(Run run, int spacings, std::size_t rows, bool gated) {
  constexpr double length = 2;
  const double d = length / spacings;
  std::vector<double> lost;
  for (const auto& file : truth_of("standing_wave")) {
    for (std::size_t row = 0; row < std::min(rows, file.column("kh").size()); ++row) {
      const double depth = d * std::round(file.column("kh")[row] * length / pi / d);
      // A lattice of 130 layers that has settled for only 40 frames still bounces: its sway was twice the
      // wave's.
      const int frames = std::max(40, static_cast<int>(std::lround(1.25 * depth / d)));
      const State rest = settled(run.backend, {length, depth, 6 * d}, d, frames);
      lost.push_back(wave_swings(run, file, row, d, length, rest, gated).damping);
    }
  }
  return lost;
}
void waves_swing_as_in_theory(Run run, int spacings, std::size_t rows) {
  if (waves_swing(run, spacings, rows, true).empty()) GTEST_SKIP() << "no file of a standing wave";
}

/// Expects the mean loss over tanks of `first` to `last` spacings to be below `limit`. A single run says
/// little: the losses have a standard deviation of 0.03 to 0.06 from one length to the next.
void waves_keep_their_amplitude(Run run, int first, int last, int step, double limit) {
  std::vector<double> lost;
  for (int spacings = first; spacings <= last; spacings += step)
    for (const double one : waves_swing(run, spacings, 1, false)) lost.push_back(one);
  if (lost.empty()) GTEST_SKIP() << "no file of a standing wave";
  const double n = static_cast<double>(lost.size());
  const double mean_lost = std::accumulate(lost.begin(), lost.end(), 0.0) / n;
  double squares = 0;
  for (const double one : lost) squares += (one - mean_lost) * (one - mean_lost);
  std::printf("%s, %d to %d spacings: a period costs %.3f of the amplitude (standard error %.3f)\n",
              run.name().c_str(), first, last, mean_lost, std::sqrt(squares / (n - 1) / n));
  EXPECT_LT(mean_lost, limit);
}

TEST(TruthWave, HiResSwingsWithItsPeriod) {
  waves_swing_as_in_theory({Backend::Cpu, MethodKind::HiRes}, 32, 1);
}
TEST(TruthWave, OursSwingsWithItsPeriod) {
  waves_swing_as_in_theory({Backend::Cpu, MethodKind::Ours}, 32, 1);
}
TEST(TruthWaveGpu, HiResSwingsWithItsPeriod) {
  waves_swing_as_in_theory({Backend::Cuda, MethodKind::HiRes}, 128, 3);
}
TEST(TruthWaveGpu, OursSwingsWithItsPeriod) {
  waves_swing_as_in_theory({Backend::Cuda, MethodKind::Ours}, 128, 3);
}

// Before still water was calmed, the means were 0.146, 0.146, 0.074 and 0.078 (standard errors 0.009, 0.016,
// 0.012, 0.011). The limits are the larger of then and now plus two standard errors.
TEST(TruthWaveSlow, HiResKeepsItsAmplitude) {
  waves_keep_their_amplitude({Backend::Cpu, MethodKind::HiRes}, 28, 40, 1, 0.17);
}
TEST(TruthWaveSlow, OursKeepsItsAmplitude) {
  waves_keep_their_amplitude({Backend::Cpu, MethodKind::Ours}, 28, 40, 1, 0.18);
}
TEST(TruthWaveGpu, HiResKeepsItsAmplitude) {
  waves_keep_their_amplitude({Backend::Cuda, MethodKind::HiRes}, 116, 140, 3, 0.1);
}
TEST(TruthWaveGpu, OursKeepsItsAmplitude) {
  waves_keep_their_amplitude({Backend::Cuda, MethodKind::Ours}, 116, 140, 3, 0.125);
}

}  // namespace
