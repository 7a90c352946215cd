#pragma once
/// Helpers of the commands that time one fluid.

#include <algorithm>
#include <memory>
#include <numeric>
#include <string>

#include "libsim/simulation.hpp"
#include "stats/base/json.hpp"

namespace measure {

/// Makes the scene at frame 0, from the stored settled state if there is one; shows the settling as a
/// progress line.
std::unique_ptr<sim::Simulation> make_settled(const sim::Scene& scene, sim::SimulationOptions options);

/// Processor model and number of logical processors.
std::string processor();

/// Density error and numbers of neighbours, averaged over states spread over the run, and the largest density
/// of these states.
struct Accuracy {
  double error_mean = 0;
  double density_max = 0;
  double neighbours_mean = 0;  ///< neighbours within the support h
  double listed_mean = 0;      ///< entries of a neighbour list, which reaches beyond h
  int samples = 0;
  void add(const sim::FrameReport& report) {
    ++samples;
    error_mean += (report.density_error_mean - error_mean) / samples;
    neighbours_mean += (report.neighbours_mean - neighbours_mean) / samples;
    listed_mean += (report.listed_mean - listed_mean) / samples;
    density_max = std::max(density_max, report.density_max);
  }
};

/// Number of frames from one measurement to the next, for about ten measurements per run. It has no common
/// divisor with the period of level changes, so that the measurements fall on all frames of this period
/// nearly equally often: water is denser in the frame in which levels change than before the next change.
inline int tenth_of(int frames, sim::MethodKind method, const sim::Readings& readings) {
  const int turn = sim::traits_of(method).adaptive() ? std::max(1, readings.levels_period_frames) : 1;
  int out = std::max(1, frames / 10);
  while (std::gcd(out, turn) > 1) ++out;
  return out;
}

/// Substeps over all frames.
struct Substeps {
  int taken = 0, most = 0;
  int bound = 0;  ///< frames that required more substeps than the limit
  void add(sim::SubstepCount count) {
    taken += count.taken;
    most = std::max(most, count.taken);
    bound += count.wished > count.taken;
  }
  double mean(int frames) const { return static_cast<double>(taken) / frames; }
};

// Totals of a scene's effects over a run.

/// {"foam": {...}, "heat": {...}} for the listed effects with a coefficient above 0; an empty object without
/// any. Foam: numbers of diffuse particles, and the volume of all particles emitted, m3. Heat, K m_*: kelvin
/// above the effect's reference times mass in units of m_*, the mass of a finest particle.
base::Json effect_books(const sim::Scene& scene, const sim::FrameReport& report);
/// One line per effect for readers, as `vip-bench frame` prints them.
std::string in_words(const base::Json& books);

}  // namespace measure
