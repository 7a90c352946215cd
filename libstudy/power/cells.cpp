#include "libstudy/power/cells.hpp"

#include <fmt/core.h>
#include <algorithm>

#include "stats/base/file.hpp"

namespace study {

namespace {

int studies_of_cell(const PowerRequest& request, int n) {
  constexpr int participants = 100000, participants_by_model = 5000, most = 10000;
  const bool by_model = request.plan.plan.tests == stats::ScoreTests::Mixed;
  return std::clamp((by_model ? participants_by_model : participants) / n, 1, most);
}

}  // namespace

std::string to_text(const PowerCell& cell) {
  return fmt::format("{} participants, studies {} to {}", cell.n, cell.studies.first + 1,
                     cell.studies.first + cell.studies.count);
}

std::vector<PowerCell> power_cells(const PowerRequest& request) {
  const std::string common = studies_json(request).dump();
  std::vector<PowerCell> out;
  for (const int n : request.n) {
    const int step = studies_of_cell(request, n);
    for (int first = 0; first < request.studies; first += step) {
      PowerCell cell{{}, n, {first, std::min(step, request.studies - first)}};
      cell.key = base::sha256_hex(common + "\n" + to_text(cell)).substr(0, 16);
      out.push_back(std::move(cell));
    }
  }
  return out;
}

StudyOutcomes simulate_studies(const PowerRequest& request, StudyRange studies) {
  if (power_kind(request.protocol) == PowerKind::Pilot) return simulate_pilots(request, studies);
  return count_task_studies(request, studies);
}

StudyOutcomes simulate_cell(const PowerRequest& request, const PowerCell& cell) {
  PowerRequest part = request;
  part.n = {cell.n};
  return simulate_studies(part, cell.studies);
}

Json power_json(const PowerRequest& request, const StudyOutcomes& outcomes) {
  if (const auto* pilots = std::get_if<PilotOutcomes>(&outcomes))
    return power_json(request, pilot_power(request, *pilots));
  return power_json(request, task_power(request, std::get<TaskCounts>(outcomes)));
}

}  // namespace study
