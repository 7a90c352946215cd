#pragma once
/// A scene, a method and the knobs that trade time for accuracy: what a cell of an accuracy sweep runs, and
/// what a program runs that was given a sweep's choice.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libsim/scene/scene.hpp"
#include "libsim/simulation.hpp"

namespace apps {

enum class SolverKnob {
  Size,          ///< n_*
  Rate,          ///< frames of content a second
  Iterations,    ///< projections a substep
  Substeps,      ///< a frame; 0 = as many as the fastest particle asks for
  CoarseCycles,  ///< V-cycles of the coarse pressure
  Momentum,      ///< share of the last projection taken again
  Levels,        ///< N
  Alpha,         ///< weight of the temporal feature, Eq. 1
  Fovea,         ///< theta_f, degrees, Eq. 3
  Beta           ///< lowest probability of being solved, Algorithm 3; 1 = no temporal acceleration
};
inline constexpr std::size_t solver_knob_count = 10;

/// A knob as data. Values are tried one at a time around the default.
struct SolverKnobTraits {
  SolverKnob knob{};
  const char* column = "";     ///< its name in files, with its unit
  const char* words = "";      ///< for a reader
  bool of_levels = false;      ///< means nothing to a method that neither splits nor merges
  bool of_saliency = false;    ///< means nothing to a method whose levels follow the gaze alone
  double least = 0, most = 0;  ///< that a setting may have
  bool whole = false;
  double usual = 0;
  std::vector<double> others = {};  ///< tried besides; of Size: as multiples of the usual
};
const std::array<SolverKnobTraits, solver_knob_count>& solver_knobs();
const SolverKnobTraits& traits_of(SolverKnob knob);

struct SolverSetting {
  std::string scene = "SingleDam";  ///< as scenes_of names it
  sim::MethodKind method = sim::MethodKind::Ours;
  std::array<double, solver_knob_count> values{};  ///< in the order of SolverKnob

  double operator[](SolverKnob knob) const { return values[static_cast<std::size_t>(knob)]; }
  double& operator[](SolverKnob knob) { return values[static_cast<std::size_t>(knob)]; }
  bool operator==(const SolverSetting&) const = default;
};

/// All knobs as the programs have them.
SolverSetting usual_setting(const std::string& scene, sim::MethodKind method, std::int64_t n_star);
/// Whether the knob means anything to the method.
bool turns(SolverKnob knob, sim::MethodKind method);

/// A knob's value for a reader and for programs: "16384", "0.7866".
std::string value_words(SolverKnob knob, double value);

/// "SingleDam Ours n_star=32768 frames_per_s=60 ...", with the knobs that mean something to the method: equal
/// texts run alike.
std::string to_text(const SolverSetting& setting);

/// What a program that was given these options runs, as a setting. Beta is NaN where it follows the frame
/// rate.
SolverSetting setting_of(const sim::Scene& scene, const sim::SimulationOptions& options);

/// For the solver; `seed` is that of temporal acceleration.
sim::SimulationOptions to_options(const SolverSetting& setting, sim::Backend backend, std::uint32_t seed);

}  // namespace apps
