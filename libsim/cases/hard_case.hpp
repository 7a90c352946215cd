#pragma once
/// Hard cases of the fluid, S1 to S24, each defined once for tests and for the stability map. docs/results.md
/// describes each case and the measured results.

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "libsim/simulation.hpp"

namespace sim::cases {

/// Size of a case. Small: takes seconds on one core. Full: the size in the table of hard cases in
/// docs/results.md.
enum class Size { Small, Full };

/// Parameters of a case. For times and counts, 0 = the case's own value.
struct Setting {
  MethodKind method = MethodKind::HiRes;
  Backend backend = Backend::Cpu;
  double frame_dt_s = 0;  ///< simulated time of a frame
  int substeps = 0;       ///< per frame
  int iterations = 0;     ///< constraint projections per substep, 1 .. LiveNumbers::most_iterations
  double scale = 1;       ///< factor for HardCase::scaled, > 0
  Size size = Size::Small;
  /// Effects in addition to the scene's; settled start states are computed without them.
  std::vector<Effect> effects = {};
};

/// One measured quantity with its gate, the limit that it must meet.
struct Finding {
  enum class Gate { AtMost, AtLeast, Reported };

  std::string name;
  double value = 0;
  Gate gate = Gate::Reported;
  double limit = 0;
  /// The limit that the case requires (column "asked" in docs/results.md); none = `limit`. Where `limit` is
  /// looser, docs/results.md has the reason.
  std::optional<double> asked;
  std::string unit;  ///< empty = a ratio or a count

  /// True if the value meets its limit; false for NaN with a limit.
  bool passes() const;
  /// Distance to the limit, as a share of the limit: 0 at the limit, below 0 beyond it. Infinite for a value
  /// that is only reported, and for a limit of 0 that is met. -infinite for a value that is not finite, and
  /// for a limit of 0 that is not met.
  double margin() const;
};

/// When and why a run stopped early.
struct Stop {
  int frame = 0;  ///< frames since the start
  std::string cause;
};

/// The result of a case.
struct Outcome {
  std::vector<Finding> findings;
  std::optional<Stop> stopped;  ///< set if the run failed and stopped early

  bool passes() const;
  /// The smallest margin of the findings; at most -1 for a stopped run.
  double margin() const;
  /// One line: each finding with its limit, and the reason of a stop.
  std::string text() const;
};

/// True if the finding measures lost, braked or compressed water: particles outside the tank, particles whose
/// speed the solver limited, or the largest rho / rho_0. Its limit applies with effects too. Other findings,
/// such as where and how fast water comes to rest, may change with effects.
bool is_of_stability(const Finding& finding);
/// The outcome with only those findings for which is_of_stability() is true.
Outcome of_stability(Outcome outcome);

struct HardCase {
  const char* id;     ///< such as "S2"; a variant of a case has a letter: "S8b"
  const char* suite;  ///< name of its test suite, such as "S02TallColumn"
  const char* title;
  const char* asked;  ///< requirement in words
  std::vector<MethodKind> methods;
  /// The quantity that Setting::scale multiplies, such as "30 m/s of the jet"; empty = the case has none.
  const char* scaled;
  /// simulated time of a frame, s, if the setting has none; for S8, the shortest of its three frame times
  double frame_dt_s;
  int iterations;  ///< projections per substep, if the setting has none
  /// base::Error for a missing back end; results of the simulation are never an error.
  Outcome (*run)(const Setting&);
};

/// All hard cases, in ascending order of their ids.
const std::vector<HardCase>& hard_cases();
/// The case with this id; base::Error that names the known cases if there is none.
const HardCase& hard_case(std::string_view id);

}  // namespace sim::cases
