#pragma once
/// How the time of one fluid grows with its particles, as numbers, a table and a picture.

#include <limits>
#include <string>
#include <vector>

#include "apps/bench/cells.hpp"

namespace apps {

/// One size.
struct GrowthRow {
  std::string n_star;
  double particles = 0;        ///< mean over frames
  double substeps_mean = 0;    ///< a frame
  double ms_substep_mean = 0;  ///< ms of all frames over substeps of all frames
  double ms_substep_p99 = 0;   ///< over frames, of a frame's ms over its substeps
  double ms_frame_mean = 0;
  double density_error_mean = 0;  ///< mean of max(rho / rho_0 - 1, 0)
  /// Simulation::particle_bytes over the particles that are there last: columns of the particles and what
  /// saliency, temporal acceleration, nozzles and outlets keep, at their capacity. Neighbour lists, cells and
  /// the grids of the pressure are not in it.
  double column_bytes = 0;
  /// What the device's memory holds after the run above what it held before the fluid was made, over the same
  /// particles; NaN on the CPU.
  double device_bytes = std::numeric_limits<double>::quiet_NaN();
};

/// ms a substep = factor particles^exponent, by least squares over the logarithms.
struct Growth {
  double exponent = 0, factor = 0;
  /// Of the exponent; NaN with two sizes, which lie on a line.
  double standard_error = std::numeric_limits<double>::quiet_NaN();
};
/// base::Error unless two rows have different numbers of particles.
Growth growth_of(const std::vector<GrowthRow>& rows);

/// "exponent 1.020, standard error 0.031, over 4 sizes"
std::string in_words(const Growth& growth, std::size_t sizes);

/// What ran, as it stands before each row and over the picture.
struct GrowthRun {
  std::string scene, method, backend;
  int frames = 0;  ///< a size
};
/// A row a size; the exponent and its error stand in each.
TextTable to_table(const GrowthRun& run, const std::vector<GrowthRow>& rows, const Growth& growth);
/// ms a substep over particles, with the 99th percentile as a stroke.
std::string to_svg(const GrowthRun& run, const std::vector<GrowthRow>& rows, const Growth& growth);

}  // namespace apps
