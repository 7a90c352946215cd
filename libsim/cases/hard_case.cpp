#include "libsim/cases/hard_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libsim/cases/cases.hpp"
#include "stats/base/error.hpp"

namespace sim::cases {

namespace {
constexpr double infinite = std::numeric_limits<double>::infinity();
}

bool Finding::passes() const {
  switch (gate) {
    case Gate::AtMost:
      return value <= limit;
    case Gate::AtLeast:
      return value >= limit;
    case Gate::Reported:
      return true;
  }
  return false;
}

double Finding::margin() const {
  if (gate == Gate::Reported) return infinite;
  if (!std::isfinite(value)) return -infinite;
  const double left = gate == Gate::AtMost ? limit - value : value - limit;
  if (limit == 0) return left >= 0 ? infinite : -infinite;
  return left / std::abs(limit);
}

bool Outcome::passes() const {
  return !stopped &&
         std::all_of(findings.begin(), findings.end(), [](const Finding& one) { return one.passes(); });
}

double Outcome::margin() const {
  double least = stopped ? -1 : infinite;
  for (const Finding& one : findings) least = std::min(least, one.margin());
  return least;
}

bool is_of_stability(const Finding& finding) {
  return finding.name.ends_with("particles outside") || finding.name.ends_with("braked") ||
         finding.name.find("largest rho / rho_0") != std::string::npos;
}

Outcome of_stability(Outcome outcome) {
  std::erase_if(outcome.findings, [](const Finding& one) { return !is_of_stability(one); });
  return outcome;
}

std::string Outcome::text() const {
  std::string out;
  for (const Finding& one : findings) {
    out += fmt::format("{}{} {:.4g}{}{}", out.empty() ? "" : ", ", one.name, one.value,
                       one.unit.empty() ? "" : " ", one.unit);
    if (one.gate == Finding::Gate::Reported) continue;
    out += fmt::format(" ({} {:.4g}", one.gate == Finding::Gate::AtMost ? "at most" : "at least", one.limit);
    if (one.asked && *one.asked != one.limit) out += fmt::format(", asked {:.4g}", *one.asked);
    out += one.passes() ? ")" : ", FAILS)";
  }
  if (stopped) out += fmt::format("; stopped at frame {}: {}", stopped->frame, stopped->cause);
  return out;
}

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
