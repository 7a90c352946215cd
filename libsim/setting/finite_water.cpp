#include "libsim/setting/finite_water.hpp"

#include <fmt/core.h>

#include <cmath>
#include <cstdio>

#include "stats/base/error.hpp"
#include "stats/base/streams.hpp"

namespace sim {

namespace {
std::string first_of(const Simulation& fluid) {
  const auto divergence = fluid.divergence();
  return divergence ? "; first trouble: " + in_words(*divergence) : "";
}

std::string part_of(std::uint64_t count, const char* one, const char* many, const char* what) {
  return count == 0 ? "" : fmt::format(", {} {} {}", count, count == 1 ? one : many, what);
}
}  // namespace

GuardCounts sum(const GuardCounts& a, const GuardCounts& b) {
  return {.speed_limited = a.speed_limited + b.speed_limited,
          .coincident_pairs = a.coincident_pairs + b.coincident_pairs,
          .not_finite = a.not_finite + b.not_finite,
          .neighbours_dropped = a.neighbours_dropped + b.neighbours_dropped,
          .wall_projected = a.wall_projected + b.wall_projected,
          .nozzle_waited = a.nozzle_waited + b.nozzle_waited,
          .saliency_not_finite = a.saliency_not_finite + b.saliency_not_finite,
          .gaze_lost = a.gaze_lost + b.gaze_lost};
}

std::string in_words(const GuardCounts& met) {
  const std::string parts =
      part_of(met.speed_limited, "particle-substep", "particle-substeps", "braked by the limit on speed") +
      part_of(met.coincident_pairs, "neighbour", "neighbours",
              "in a particle's own place (counted in each projection)") +
      part_of(met.not_finite, "particle", "particles", "not finite or far outside the tank") +
      part_of(met.neighbours_dropped, "neighbour", "neighbours", "left out because a list was full") +
      part_of(met.nozzle_waited, "layer", "layers",
              "that a nozzle did not pour for want of water in the tank's corners or of room for particles") +
      part_of(met.saliency_not_finite, "saliency", "saliencies", "not finite");
  return parts.empty() ? "" : "guards stepped in: " + parts.substr(2);
}

void print_guards(const std::string& place, const GuardCounts& met, const std::optional<Divergence>& first) {
  std::string line = in_words(met);
  if (first) line += (line.empty() ? "" : "; ") + ("first trouble: " + in_words(*first));
  if (line.empty()) return;
  std::fflush(stdout);
  std::fprintf(stderr, "%s: %s\n", base::for_terminal(place).c_str(), line.c_str());
}

void print_guards(const std::string& place, Simulation& fluid) {
  print_guards(place, fluid.report().guards, fluid.divergence());
}

void check_finite(Simulation& fluid, const std::string& place) {
  const FrameReport report = fluid.report();
  const bool finite = std::isfinite(report.density_error_mean) && std::isfinite(report.speed_max_m_s);
  if (report.guards.not_finite == 0 && finite) return;
  const std::string cause = report.guards.not_finite > 0
                                ? std::to_string(report.guards.not_finite) +
                                      " times a particle was not finite or far outside the tank"
                                : "its mean density error or largest speed is not finite";
  throw base::Error(
      place, "the simulation failed: " + cause + ", so its results cannot be used" + first_of(fluid),
      "use shorter frames (a higher frames_per_s in the scene), more substeps (min_substeps), or "
      "numbers of the solver nearer to the defaults");
}

}  // namespace sim
