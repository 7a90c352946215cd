#pragma once
/// Hard cases of the fluid, S1 to S24: one definition of each, for tests and for the stability map.
/// docs/stability.md says what each asks and what was measured.

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "libsim/simulation.hpp"

namespace sim::cases {

/// Small: seconds on one core. Full: what the case asks for.
enum class Size { Small, Full };

/// What a case may be run with. 0 = the case's own.
struct Setting {
  MethodKind method = MethodKind::HiRes;
  Backend backend = Backend::Cpu;
  double frame_dt_s = 0;  ///< content time of a frame
  int substeps = 0;       ///< in every frame
  int iterations = 0;     ///< constraint projections a substep, 1 .. LiveNumbers::most_iterations
  double scale = 1;       ///< of HardCase::scaled, > 0
  Size size = Size::Small;
  std::vector<Effect> effects = {};  ///< that the water has besides; what has settled before has none
};

/// One measured quantity with its gate.
struct Finding {
  enum class Gate { AtMost, AtLeast, Reported };

  std::string name;
  double value = 0;
  Gate gate = Gate::Reported;
  double limit = 0;
  /// What the catalogue of cases asks for where a gate may be looser (docs/stability.md has the reason).
  std::optional<double> asked;
  std::string unit;  ///< empty = a ratio or a count

  /// False for a value that is not a number.
  bool passes() const;
  /// What is left to the limit, as a share of it: 0 at the limit, below 0 beyond it. Infinite where there is
  /// nothing to be near to: what is only reported, and a limit of nobody that is kept.
  double margin() const;
};

/// Why a run ended before its time.
struct Stop {
  int frame = 0;  ///< frames since the start
  std::string cause;
};

/// What a case came to.
struct Outcome {
  std::vector<Finding> findings;
  std::optional<Stop> stopped;  ///< a run that has failed already goes no further

  bool passes() const;
  /// The smallest of the findings'; -1 at most for a run that was stopped.
  double margin() const;
  /// One line: each finding with its gate, and what stopped the run.
  std::string text() const;
};

/// Whether it says that the water is lost, braked or pressed together: what no effect may change. The others
/// say where and how fast water comes to rest and the like, which effects are there to change.
bool is_of_stability(const Finding& finding);
/// The outcome by these findings alone.
Outcome of_stability(Outcome outcome);

struct HardCase {
  const char* id;     ///< "S2"; a second case of the same row has a letter: "S8b"
  const char* suite;  ///< of its tests: "S02TallColumn"
  const char* title;
  const char* asked;  ///< in words
  std::vector<MethodKind> methods;
  const char* scaled;  ///< what Setting::scale multiplies: "30 m/s of the jet"; empty = nothing
  double frame_dt_s;   ///< the case's own, s
  int iterations;      ///< the case's own
  /// base::Error for a back end that is not there; what the water does is never an error.
  Outcome (*run)(const Setting&);
};

/// In the order of their ids.
const std::vector<HardCase>& hard_cases();
/// base::Error that names the known ones.
const HardCase& hard_case(std::string_view id);

}  // namespace sim::cases
