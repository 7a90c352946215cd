#pragma once
/// The raw results of one cell of a sweep: the state of the water over time, the time of each frame, and
/// pictures.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace study {

/// A stored picture of the water. It is compared with the reference's picture when a table is made.
struct KeptPicture {
  double time_s = 0;  ///< time since frame 0
  std::string png;
  /// Masks of the fovea and of the most salient part, packed by to_bits(). Only runs of the reference setting
  /// store masks, and only with the first picture of each pair (two pictures 1/30 s apart); otherwise empty.
  std::string fovea = {}, salient = {};
};

/// Packs a byte mask (0 or not) into one bit per pixel, lowest bit first.
std::string to_bits(const std::vector<std::uint8_t>& mask);
/// Unpacks a mask into one byte per pixel, 1 or 0. Empty if `bits` holds fewer bits than pixels.
std::vector<std::uint8_t> from_bits(const std::string& bits, std::size_t pixels);

/// The water at one instant. Energies are per kilogram, J/kg.
struct WaterSample {
  double time_s = 0;     ///< time since frame 0
  double front_m = 0;    ///< position of the water's front: the smallest x up to which 99 % of the mass lies
  double centre_m[3]{};  ///< centre of mass: x, y, z
  double kinetic_j_kg = 0;
  double density_error = 0;  ///< mean over the particles of max(rho / rho_0 - 1, 0)
  double density_max = 0;    ///< largest rho / rho_0
};

struct FrameCost {
  /// Time of the solver. If a method that depends on pictures gets the last picture, the time includes
  /// passing that picture to the solver.
  double solve_ms = 0;
  /// Time of passing the particles to OpenGL and of rendering them; empty: no picture is drawn.
  std::optional<double> draw_ms;
  double all_ms() const { return solve_ms + draw_ms.value_or(0); }
};

struct CellRun {
  /// State of the water every 1/30 s. The first sample is taken 1/30 s after frame 0.
  std::vector<WaterSample> samples;
  std::vector<FrameCost> frames;  ///< all frames except the first five, in which buffers grow
  /// Ten pairs of pictures a second; the pictures of a pair are 1/30 s apart. Empty if the cell names no
  /// size of stored pictures (SweepCell::kept).
  std::vector<KeptPicture> pictures = {};
  double pixels_per_degree = 0;  ///< resolution of the pictures at their centre; 0 without pictures
  double particles_mean = 0, substeps_mean = 0;
  std::int64_t braked = 0;  ///< number of times that the speed limit slowed a particle in a substep
};

}  // namespace study
