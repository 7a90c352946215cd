#pragma once
/// A scene, a method and the parameters (knobs) that trade time for accuracy: one cell of an accuracy sweep,
/// or the setting that a program runs.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libsim/scene/scene.hpp"
#include "libsim/simulation.hpp"

namespace sim {

enum class SolverKnob {
  Size,          ///< n_*, number of particles if all have the coarsest level
  Rate,          ///< frames per second of fluid time
  Iterations,    ///< projections per substep
  Substeps,      ///< per frame; 0 = as many as speeds, forces and effects need
  CoarseCycles,  ///< V-cycles of the coarse pressure
  Momentum,      ///< factor on the last projection's displacement, which the next one repeats
  Levels,        ///< N, number of levels
  Alpha,         ///< weight of the temporal feature, Eq. 1
  Fovea,         ///< theta_f, degrees, Eq. 3
  Beta           ///< lowest probability that a particle is solved, Algorithm 3; 1 = no temporal acceleration
};
inline constexpr std::size_t solver_knob_count = 10;

/// Properties of a knob. A sweep tries the values of each knob with the other knobs at their defaults, and
/// combinations of some knobs (libstudy/sweep/matrix.cpp).
struct SolverKnobTraits {
  SolverKnob knob{};
  const char* column = "";     ///< name in files, with its unit
  const char* words = "";      ///< name for readers
  bool of_levels = false;      ///< has no effect with a method that neither splits nor merges
  bool of_saliency = false;    ///< has no effect with a method whose levels follow the gaze alone
  double least = 0, most = 0;  ///< allowed range of a setting
  bool whole = false;
  double usual = 0;
  std::vector<double> others = {};  ///< further values to try; for Size, multiples of the default
};
const std::array<SolverKnobTraits, solver_knob_count>& solver_knobs();
const SolverKnobTraits& traits_of(SolverKnob knob);

struct SolverSetting {
  std::string scene = "SingleDam";  ///< Scene::name; in a sweep, a name that scenes_of() knows
  MethodKind method = MethodKind::Ours;
  std::array<double, solver_knob_count> values{};  ///< in the order of SolverKnob

  double operator[](SolverKnob knob) const { return values[static_cast<std::size_t>(knob)]; }
  double& operator[](SolverKnob knob) { return values[static_cast<std::size_t>(knob)]; }
  bool operator==(const SolverSetting&) const = default;
};

/// The programs' defaults for all knobs except Size, which is n_star.
SolverSetting usual_setting(const std::string& scene, MethodKind method, std::int64_t n_star);
/// True if the knob has an effect with the method.
bool turns(SolverKnob knob, MethodKind method);

/// A knob's value as text, for readers and for programs: "16384", "0.7866".
std::string value_words(SolverKnob knob, double value);

/// "SingleDam Ours n_star=32768 frames_per_s=60 ...", with the knobs that have an effect with the method:
/// settings with equal texts give equal runs.
std::string to_text(const SolverSetting& setting);

/// The setting that a program with these options runs. With temporal acceleration, Beta is NaN unless
/// TemporalOptions::fixed_tau is set.
SolverSetting setting_of(const Scene& scene, const SimulationOptions& options);

/// Options for the solver; `seed` is that of temporal acceleration.
SimulationOptions to_options(const SolverSetting& setting, Backend backend, std::uint32_t seed);

}  // namespace sim
