#include "libsim/cases/cases.hpp"
#include "stats/base/error.hpp"

namespace sim::cases {

std::vector<MethodKind> every_method() {
  std::vector<MethodKind> out;
  for (const MethodTraits& method : all_methods()) out.push_back(method.kind);
  return out;
}

const std::vector<HardCase>& hard_cases() {
  static const std::vector<HardCase> all{
      rest_tank(),  tall_column(), mass_interface(), tension(),    big_steps(), peers_dam(),       jet(),
      thin_sheet(), corners(),     wedge(),          coincident(), gaze(),      energy_of_a_dam(), soak()};
  return all;
}

const HardCase& hard_case(std::string_view id) {
  std::string known;
  for (const HardCase& one : hard_cases()) {
    if (one.id == id) return one;
    known += (known.empty() ? "" : ", ") + std::string(one.id);
  }
  throw base::Error("case '" + std::string(id) + "'", "is none of the hard cases", "use one of: " + known);
}

}  // namespace sim::cases
