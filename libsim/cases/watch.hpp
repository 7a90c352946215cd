#pragma once
/// A run of a hard case that is measured after each frame.

#include <string>
#include <vector>

#include "libsim/cases/hard_case.hpp"
#include "libsim/cases/water.hpp"

namespace sim::cases {

/// Limits of measured values; a run beyond a limit has failed and stops.
struct Bounds {
  double density = std::numeric_limits<double>::infinity();  ///< rho / rho_0
  double speed_m_s = std::numeric_limits<double>::infinity();
  double outside_m = std::numeric_limits<double>::infinity();  ///< distance beyond floor and walls
};

class Watch {
 public:
  Watch(const Scene& scene, const SimulationOptions& options, const Bounds& bounds);

  /// Computes a frame and measures it. False once the run has stopped: a value was not finite or beyond the
  /// bounds.
  bool step();

  Simulation& fluid() { return *fluid_; }
  const State& state() const { return state_; }  ///< after the last frame
  const FrameReport& report() const { return report_; }
  int frame() const { return frame_; }
  double densest() const { return densest_; }  ///< largest rho / rho_0 over all frames
  /// Quantile of the frames' largest rho / rho_0: the value that this share of the frames does not exceed,
  /// 0 < share <= 1; 0 if there is no frame.
  double densest_in(double share) const;
  double fastest_m_s() const { return fastest_; }
  int out() const { return out_; }                    ///< largest number of particles outside in a frame
  int short_frames() const { return short_frames_; }  ///< frames that requested more substeps than they got

  /// Findings shared by most cases. The limits of density and speed are those of Bounds; the limit of the
  /// number of particles outside is 0.
  Finding density_finding() const;
  Finding speed_finding() const;
  Finding outside_finding() const;
  /// The case's result: the given findings, and the reason of a stop if the run has stopped.
  Outcome outcome(std::vector<Finding> findings) const;

 private:
  void end(const std::string& cause);

  Scene scene_;
  Bounds bounds_;
  std::unique_ptr<Simulation> fluid_;
  State state_;
  FrameReport report_;
  int frame_ = 0;
  std::vector<double> densities_;  ///< largest rho / rho_0 of each frame
  double densest_ = 0, fastest_ = 0;
  int out_ = 0, short_frames_ = 0;
  std::optional<Stop> stopped_;
};

/// The scene with the setting's effects in addition to its own.
Scene with_effects(Scene scene, const Setting& setting);
/// Options with the setting's method, back end and parameters. The method Ours-TSp runs at a constant
/// tolerance tau = -10 frames/s; the lowest probability that a particle is solved is then 0.67.
SimulationOptions options_of(const Setting& setting);
/// Options for a run that starts with the particles `start`. Sets the size of the scene's water and n_*
/// (number of particles if all are coarsest) so that the finest spacing is d (libsim/cases/water.hpp).
SimulationOptions options_of(const Setting& setting, Scene& scene, const State& start);
/// Simulated time of a frame, s: the setting's or `usual`.
double frame_dt_of(const Setting& setting, double usual = 1.0 / 60);
/// Number of frames in this simulated time; at least one.
int frames_of(const Setting& setting, double seconds, double usual_dt_s = 1.0 / 60);

Finding at_most(std::string name, double value, double limit, std::string unit = "");
Finding at_least(std::string name, double value, double limit, std::string unit = "");
Finding reported(std::string name, double value, std::string unit = "");

}  // namespace sim::cases
