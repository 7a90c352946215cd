#include "libstudy/power/shard.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <limits>
#include <stdexcept>
#include <tuple>

#include "stats/base/json.hpp"

namespace study {

namespace {

namespace fs = std::filesystem;

int studies_of_cell(const PowerRequest& request, int n) {
  constexpr int participants = 100000, participants_by_model = 5000, most = 10000;
  const bool by_model = request.plan.plan.tests == stats::ScoreTests::Mixed;
  return std::clamp((by_model ? participants_by_model : participants) / n, 1, most);
}

constexpr ShardKind power_shard_kind{"vip-stats power", "vip-power-shard/1", "studies",
                                     "the --n and --studies"};

// References to the numbers of a count or of a pilot's outcome, in the order in which a shard's lists hold
// them; for writing and reading.
auto figures(auto& count) requires requires { count.holds; }
{
  return std::tie(count.holds, count.uncorrected, count.against, count.refused, count.estimates,
                  count.estimate_units, count.participants_least, count.participants_most);
}
auto figures(auto& count) requires requires { count.supported; }
{ return std::tie(count.supported, count.any, count.any_false, count.paper); }
auto figures(auto& pilot) requires requires { pilot.fitted; }
{
  auto &a = pilot.a, &b = pilot.b;
  return std::tie(pilot.fitted, pilot.interval, a.value, a.se, a.ci[0], a.ci[1], b.value, b.se, b.ci[0],
                  b.ci[1]);
}

Json written(const auto& entry) {
  const auto json = [](auto value) {
    if constexpr (std::is_same_v<decltype(value), double>) return json_number(value);
    return Json(value);
  };
  return std::apply([&](const auto&... value) { return Json::array({json(value)...}); }, figures(entry));
}

/// Reads a number that json_number() wrote.
void fill(double& out, const Json& json) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  if (json.is_null())
    out = std::numeric_limits<double>::quiet_NaN();
  else if (json.is_string())
    out = json == "Inf" ? inf : -inf;
  else
    json.get_to(out);
}
template <class Whole>
void fill(Whole& out, const Json& json) {
  json.get_to(out);
}

template <class Entry>
void fill_entry(Entry& entry, const Json& list) {
  std::apply(
      [&](auto&... value) {
        expect_size(list, sizeof...(value));
        std::size_t i = 0;
        (fill(value, list[i++]), ...);
      },
      figures(entry));
}

Json written(const StudyOutcomes& outcomes) {
  Json out = Json::array();
  if (const auto* pilots = std::get_if<PilotOutcomes>(&outcomes)) {
    for (const auto& pilot : pilots->front()) out.push_back(written(pilot));
    return out;
  }
  for (const auto& hypothesis : std::get<TaskCounts>(outcomes).front()) {
    Json tests = Json::array();
    for (const auto& test : hypothesis.tests) tests.push_back(written(test));
    out.push_back(Json::array({written(hypothesis), std::move(tests)}));
  }
  return out;
}

/// Adds one cell's counts to `sum`. `sum` must already hold all hypotheses and tests, with counts of 0 or
/// more studies.
void add_outcomes(std::vector<HypothesisCount>& sum, const Json& outcomes) {
  expect_size(outcomes, sum.size());
  auto counts = sum;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    expect_size(outcomes[i], 2);
    fill_entry(counts[i], outcomes[i][0]);
    expect_size(outcomes[i][1], counts[i].tests.size());
    for (std::size_t t = 0; t < counts[i].tests.size(); ++t)
      fill_entry(counts[i].tests[t], outcomes[i][1][t]);
  }
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i].add(counts[i]);
}

void put_pilots(std::vector<PilotOutcome>& pilots, StudyRange studies, const Json& outcomes) {
  expect_size(outcomes, static_cast<std::size_t>(studies.count));
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    fill_entry(pilots.at(static_cast<std::size_t>(studies.first) + i), outcomes[i]);
}

}  // namespace

std::vector<PowerCell> power_cells(const PowerRequest& request) {
  const Json common = studies_json(request);
  std::vector<PowerCell> out;
  for (const int n : request.n) {
    const int step = studies_of_cell(request, n);
    for (int first = 0; first < request.studies; first += step) {
      const StudyRange studies{first, std::min(step, request.studies - first)};
      const std::string words =
          fmt::format("{} participants, studies {} to {}", n, first + 1, first + studies.count);
      out.push_back({make_cell(common, words), n, studies});
    }
  }
  return out;
}

StudyOutcomes simulate_studies(const PowerRequest& request, StudyRange studies) {
  if (power_kind(request.protocol, request.plan.plan) == PowerKind::Pilot)
    return simulate_pilots(request, studies);
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

void run_cell(const PowerRequest& request, const PowerCell& cell, const fs::path& file) {
  write_shard(
      power_shard_kind, studies_json(request), cell, [&] { return written(simulate_cell(request, cell)); },
      file);
}

StudyOutcomes join_shards(const PowerRequest& request, const std::vector<fs::path>& files) {
  const auto cells = power_cells(request);
  StudyOutcomes out = simulate_studies(request, {0, 0});
  auto* pilots = std::get_if<PilotOutcomes>(&out);
  if (pilots)
    for (auto& of_n : *pilots) of_n.resize(static_cast<std::size_t>(request.studies));
  read_shards(power_shard_kind, studies_json(request), {cells.begin(), cells.end()}, files,
              [&](std::size_t at, const Json& outcomes) {
                const PowerCell& cell = cells[at];
                const auto n = static_cast<std::size_t>(
                    std::find(request.n.begin(), request.n.end(), cell.n) - request.n.begin());
                if (pilots)
                  put_pilots(pilots->at(n), cell.studies, outcomes);
                else
                  add_outcomes(std::get<TaskCounts>(out).at(n), outcomes);
              });
  return out;
}

}  // namespace study
