#pragma once
/// Growth of a fluid's computing time with its number of particles, as numbers, a table and a picture.

#include <limits>
#include <string>
#include <vector>

#include "libsim/measure/cells.hpp"

namespace measure {

/// Measurements of a run with one n_* (number of particles if all are coarsest).
struct GrowthRow {
  std::string n_star;
  double particles = 0;        ///< mean over frames
  double substeps_mean = 0;    ///< per frame
  double ms_substep_mean = 0;  ///< ms of all frames over substeps of all frames
  double ms_substep_p99 = 0;   ///< 99th percentile over frames of a frame's ms per substep
  double ms_frame_mean = 0;
  double density_error_mean = 0;  ///< mean of max(rho / rho_0 - 1, 0)
  /// Simulation::particle_bytes / final number of particles: the particles' columns and the data of
  /// saliency, temporal acceleration, nozzles, outlets and foam, at their capacity. Excludes neighbour lists,
  /// cells and the pressure's grids.
  double column_bytes = 0;
  /// Bytes of device memory after the run, beyond those in use before the fluid was made, per particle; NaN
  /// on the CPU.
  double device_bytes = std::numeric_limits<double>::quiet_NaN();
};

/// ms per substep = factor particles^exponent, by least squares over the logarithms.
struct Growth {
  double exponent = 0, factor = 0;
  /// Standard error of the exponent; NaN for two sizes, because a line fits two points exactly.
  double standard_error = std::numeric_limits<double>::quiet_NaN();
};
/// base::Error unless two rows have different numbers of particles.
Growth growth_of(const std::vector<GrowthRow>& rows);

/// The growth as text, such as "exponent 1.020, standard error 0.031, over 4 sizes".
std::string in_words(const Growth& growth, std::size_t sizes);

/// Labels of the run, for the table's rows and the picture's title.
struct GrowthRun {
  std::string scene, method, backend;
  int frames = 0;  ///< per size
};
/// One row per size; each repeats the exponent and its error.
figures::TextTable to_table(const GrowthRun& run, const std::vector<GrowthRow>& rows, const Growth& growth);
/// ms per substep over particles, with a stroke up to the 99th percentile.
std::string to_svg(const GrowthRun& run, const std::vector<GrowthRow>& rows, const Growth& growth);

}  // namespace measure
