#pragma once
/// Results of one cell of a sweep: the state of the water over time, the time of each frame, and pictures.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace study {

/// A picture that the cell stores, to be compared when a table is made.
struct KeptPicture {
  double time_s = 0;  ///< since the gate opened
  std::string png;
  /// Masks for comparison, packed by to_bits(); only the first picture of each pair of the
  /// reference has them.
  std::string fovea = {}, salient = {};
};

/// Packs a byte mask (0 or not) into one bit per pixel, lowest bit first.
std::string to_bits(const std::vector<std::uint8_t>& mask);
/// One byte per pixel, 1 or 0; empty if there are fewer bits than pixels.
std::vector<std::uint8_t> from_bits(const std::string& bits, std::size_t pixels);

/// The water at one instant. Energies are per kilogram, J/kg.
struct WaterSample {
  double time_s = 0;     ///< since the gate opened
  double front_m = 0;    ///< 99 % of the mass has a smaller x
  double centre_m[3]{};  ///< centre of mass
  double kinetic_j_kg = 0;
  double density_error = 0;  ///< mean of max(rho / rho_0 - 1, 0)
  double density_max = 0;    ///< rho / rho_0
};

struct FrameCost {
  double solve_ms = 0;            ///< includes passing the picture to saliency
  std::optional<double> draw_ms;  ///< transfer and rendering; none = no picture
  double all_ms() const { return solve_ms + draw_ms.value_or(0); }
};

struct CellRun {
  std::vector<WaterSample> samples;  ///< every 1/30 s, from the first after the gate opened
  std::vector<FrameCost> frames;     ///< without the first five, in which buffers grow
  /// Ten times a second, two pictures 1/30 s apart; empty unless the cell asks for them.
  std::vector<KeptPicture> pictures = {};
  double pixels_per_degree = 0;  ///< of the pictures, at their centre
  double particles_mean = 0, substeps_mean = 0;
  std::int64_t braked = 0;  ///< particle-substeps
};

}  // namespace study
