#pragma once
/// What a cell of an accuracy sweep is asked to run: a scene, a method and the knobs that trade time for
/// accuracy.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libsim/scene/scene.hpp"
#include "libsim/simulation.hpp"

namespace apps {

enum class SweepKnob {
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
inline constexpr std::size_t sweep_knob_count = 10;

/// A knob as data. Values are tried one at a time around the default.
struct SweepKnobTraits {
  SweepKnob knob{};
  const char* column = "";   ///< its name in files, with its unit
  const char* words = "";    ///< for a reader
  bool of_levels = false;    ///< means nothing to a method that neither splits nor merges
  bool of_saliency = false;  ///< means nothing to a method whose levels follow the gaze alone
  double usual = 0;
  std::vector<double> others = {};  ///< tried besides; of Size: as multiples of the usual
};
const std::array<SweepKnobTraits, sweep_knob_count>& sweep_knobs();
const SweepKnobTraits& traits_of(SweepKnob knob);

struct SweepSetting {
  std::string scene = "SingleDam";  ///< as scenes_of names it
  sim::MethodKind method = sim::MethodKind::Ours;
  std::array<double, sweep_knob_count> values{};  ///< in the order of SweepKnob

  double operator[](SweepKnob knob) const { return values[static_cast<std::size_t>(knob)]; }
  double& operator[](SweepKnob knob) { return values[static_cast<std::size_t>(knob)]; }
  bool operator==(const SweepSetting&) const = default;
};

/// All knobs as the programs have them.
SweepSetting usual_setting(const std::string& scene, sim::MethodKind method, std::int64_t n_star);
/// Whether the knob means anything to the method.
bool turns(SweepKnob knob, sim::MethodKind method);

/// "SingleDam Ours n_star=32768 frames_per_s=60 ...", with the knobs that mean something to the method: equal
/// texts run alike.
std::string to_text(const SweepSetting& setting);

/// For the solver; `seed` is that of temporal acceleration.
sim::SimulationOptions to_options(const SweepSetting& setting, sim::Backend backend, std::uint32_t seed);

}  // namespace apps
