#pragma once
/// What the commands that time one fluid share.

#include <algorithm>
#include <memory>
#include <numeric>
#include <string>

#include "libsim/simulation.hpp"

namespace apps {

/// The scene at frame 0, from the kept state where there is one; a progress line shows the settling.
std::unique_ptr<sim::Simulation> make_settled(const sim::Scene& scene, sim::SimulationOptions options);

/// Processor and cores; the operating system has no say in the numbers.
std::string processor();

/// Density error averaged over states spread over the run, so that one calm or wild moment does not decide.
struct Accuracy {
  double error_mean = 0;
  double density_max = 0;
  double neighbours_mean = 0;
  double listed_mean = 0;
  int samples = 0;
  void add(const sim::FrameReport& report) {
    ++samples;
    error_mean += (report.density_error_mean - error_mean) / samples;
    neighbours_mean += (report.neighbours_mean - neighbours_mean) / samples;
    listed_mean += (report.listed_mean - listed_mean) / samples;
    density_max = std::max(density_max, report.density_max);
  }
};

/// Every so many frames, some ten states of a run are measured. Water is denser in the frame of a turn of the
/// levels than before the next one, so states meet each of the frames between two turns nearly as often.
inline int tenth_of(int frames, sim::MethodKind method, const sim::Readings& readings) {
  const int turn = sim::traits_of(method).adaptive() ? std::max(1, readings.levels_period_frames) : 1;
  int out = std::max(1, frames / 10);
  while (std::gcd(out, turn) > 1) ++out;
  return out;
}

/// Substeps over all frames.
struct Substeps {
  int taken = 0, most = 0;
  int bound = 0;  ///< frames whose fastest particle asked for more than were allowed
  void add(sim::SubstepCount count) {
    taken += count.taken;
    most = std::max(most, count.taken);
    bound += count.wished > count.taken;
  }
  double mean(int frames) const { return static_cast<double>(taken) / frames; }
};

}  // namespace apps
