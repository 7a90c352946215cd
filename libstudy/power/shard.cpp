#include "libstudy/power/shard.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <limits>
#include <set>
#include <tuple>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"

namespace study {

namespace {

namespace fs = std::filesystem;

int studies_of_cell(const PowerRequest& request, int n) {
  constexpr int participants = 100000, participants_by_model = 5000, most = 10000;
  const bool by_model = request.plan.plan.tests == stats::ScoreTests::Mixed;
  return std::clamp((by_model ? participants_by_model : participants) / n, 1, most);
}

constexpr const char* schema = "vip-power-shard/1";
constexpr const char* head = R"({"schema":"vip-power-shard/)";
constexpr std::size_t most_bytes = std::size_t{1} << 28, most_named = 10;

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

/// std::out_of_range if `list` is no list of this size.
void expect_size(const Json& list, std::size_t size) {
  if (!list.is_array() || list.size() != size) throw std::out_of_range("size");
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

[[noreturn]] void refuse_damaged(const fs::path& file) {
  throw base::Error(file.string(), "is damaged or cut short", "delete it and run its cell again");
}

Json read_shard(const fs::path& file) {
  const std::string text = base::read_file(file, most_bytes);
  if (!text.starts_with(head)) {
    throw base::Error(file.string(), "is not a shard of vip-stats power",
                      "name files that vip-stats power --cell wrote");
  }
  const Json out = base::parse_json(text);
  if (!out.is_object() || !out.contains("studies") || !out.at("studies").is_object() ||
      !out.contains("outcomes"))
    refuse_damaged(file);
  if (out.at("schema") != schema) {
    throw base::Error(file.string(), "was written by a newer program (" + out.at("schema").dump() + ")",
                      "use the newer vip-stats; the file was left as it is");
  }
  return out;
}

/// base::Error if the shard's studies differ from the request's. The error names the first difference.
void check_studies(const fs::path& file, const Json& there, const Json& here) {
  for (const auto& [name, value] : here.items()) {
    const Json other = there.value(name, Json());
    if (other == value) continue;
    const std::string which = name == "plan" ? "" : fmt::format(" ({}, here {})", other.dump(), value.dump());
    throw base::Error(file.string(), "holds studies with another " + name + which,
                      "give the options with which its cell was run, or run the cell again");
  }
}

std::string words_of(const PowerCell& cell) { return cell.key + " (" + to_text(cell) + ")"; }

[[noreturn]] void refuse_missing(const std::vector<PowerCell>& cells, const std::set<std::string>& there) {
  std::string names;
  std::size_t missing = 0;
  for (const auto& cell : cells) {
    if (there.contains(cell.key)) continue;
    if (++missing <= most_named) names += (names.empty() ? "" : ", ") + words_of(cell);
  }
  if (missing > most_named) names += fmt::format(" and {} more", missing - most_named);
  throw base::Error("vip-stats power merge",
                    fmt::format("{} of {} cells are missing: {}", missing, cells.size(), names),
                    "run each with --cell KEY --out SHARD, and name these files as well");
}

/// Collects the outcomes of the request's cells from shards.
class Join {
 public:
  explicit Join(const PowerRequest& request)
      : request_(request),
        studies_(studies_json(request)),
        cells_(power_cells(request)),
        outcomes_(simulate_studies(request, {0, 0})) {
    if (auto* pilots = std::get_if<PilotOutcomes>(&outcomes_))
      for (auto& of_n : *pilots) of_n.resize(static_cast<std::size_t>(request.studies));
  }

  void take(const fs::path& file) {
    const Json shard = read_shard(file);
    check_studies(file, shard.at("studies"), studies_);
    const auto cell = std::find_if(cells_.begin(), cells_.end(), [&](const PowerCell& one) {
      return shard.value("key", Json()) == one.key;
    });
    if (cell == cells_.end()) {
      throw base::Error(
          file.string(),
          "holds " + shard.value("cell", Json()).dump() + ", which is no cell of this calculation",
          "give the --n and --studies that it was run with, or leave the file out");
    }
    if (!there_.insert(cell->key).second) return;
    try {
      add(*cell, shard.at("outcomes"));
    } catch (const std::out_of_range&) {
      refuse_damaged(file);
    } catch (const Json::exception&) {
      refuse_damaged(file);
    }
  }

  StudyOutcomes whole() && {
    if (there_.size() < cells_.size()) refuse_missing(cells_, there_);
    return std::move(outcomes_);
  }

 private:
  void add(const PowerCell& cell, const Json& outcomes) {
    const auto n = static_cast<std::size_t>(std::find(request_.n.begin(), request_.n.end(), cell.n) -
                                            request_.n.begin());
    if (auto* pilots = std::get_if<PilotOutcomes>(&outcomes_))
      put_pilots(pilots->at(n), cell.studies, outcomes);
    else
      add_outcomes(std::get<TaskCounts>(outcomes_).at(n), outcomes);
  }

  const PowerRequest& request_;
  Json studies_;
  std::vector<PowerCell> cells_;
  StudyOutcomes outcomes_;
  std::set<std::string> there_;
};

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
  if (fs::exists(file) && fs::file_size(file) > 0) {
    if (read_shard(file).value("key", Json()) == cell.key) return;
    throw base::Error(file.string(), "exists already and does not hold cell " + words_of(cell),
                      "name another file, or delete this one");
  }
  const Json shard{{"schema", schema},
                   {"key", cell.key},
                   {"cell", to_text(cell)},
                   {"studies", studies_json(request)},
                   {"outcomes", written(simulate_cell(request, cell))}};
  base::write_file_atomically(file, shard.dump() + "\n");
}

StudyOutcomes join_shards(const PowerRequest& request, const std::vector<fs::path>& files) {
  Join join(request);
  for (const auto& file : files) join.take(file);
  return std::move(join).whole();
}

}  // namespace study
