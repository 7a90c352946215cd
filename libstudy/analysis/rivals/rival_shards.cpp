#include "libstudy/analysis/rivals/rival_shards.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "stats/base/file.hpp"
#include "stats/base/program.hpp"

namespace study {

namespace {

constexpr ShardKind rival_shard_kind{"vip-stats compare-models", "vip-compare-shard/1", "fits",
                                     "the --models"};

/// Everything that a fit depends on, but for its model and group.
Json fits_json(const RivalData& data, const stats::RivalComparisonOptions& options) {
  std::string answers = fmt::format("{} {}\n", data.answers.choices, data.answers.people);
  for (std::size_t i = 0; i < data.answers.n(); ++i)
    answers += fmt::format("{} {} {} {}\n", data.answers.score[i], data.answers.person[i], data.setting[i],
                           fmt::join(data.timing[i], " "));
  return {{"program", base::program_words()},
          {"protocol", data.task.protocol.sha256},
          {"question", data.task.question.id},
          {"folds", options.folds},
          {"seed", options.seed},
          {"data", base::sha256_hex(answers)}};
}

Json rival_numbers_json(const std::vector<double>& numbers) {
  Json out = Json::array();
  for (const double one : numbers) out.push_back(json_number(one));
  return out;
}

std::vector<double> rival_numbers_of(const Json& json) {
  if (!json.is_array()) throw std::out_of_range("no list");
  std::vector<double> out;
  for (const Json& one : json) out.push_back(number_of(one));
  return out;
}

Json rival_fit_json(const stats::Result<stats::RivalFit>& fit) {
  if (!fit) return fit.reason();
  return Json::array({Json(fit->scores), rival_numbers_json(fit->thresholds),
                      rival_numbers_json(fit->coefficients), json_number(fit->sd_person),
                      json_number(fit->lapse), json_number(fit->log_likelihood), Json(fit->parameters)});
}

/// Reads what rival_fit_json() wrote.
stats::Result<stats::RivalFit> rival_fit_of(const Json& json) {
  if (json.is_string()) return stats::Refusal{json.text()};
  expect_size(json, 7);
  const auto at = [&](std::size_t i) -> const Json& { return json.at(i); };
  return stats::RivalFit{at(0).get<std::vector<int>>(),
                         rival_numbers_of(at(1)),
                         rival_numbers_of(at(2)),
                         number_of(at(3)),
                         number_of(at(4)),
                         number_of(at(5)),
                         at(6).get<int>()};
}

}  // namespace

std::vector<RivalCell> rival_cells(const RivalData& data, const std::vector<TimingModel>& models,
                                   const stats::RivalComparisonOptions& options) {
  constexpr int people_fitted = 50000;
  const Json common = fits_json(data, options);
  const int all = stats::rival_group_count(data.answers.people, options);
  const int step = std::max(1, people_fitted / std::max(1, data.answers.people));
  const auto rivals = rival_models(data, models);
  std::vector<RivalCell> out;
  for (std::size_t m = 0; m < rivals.size(); ++m) {
    for (int first = 0; first < all; first += step) {
      const stats::RivalGroups groups{first, std::min(step, all - first)};
      const std::string words = fmt::format("{} without each of groups {} to {} of {}", rivals[m].name,
                                            first + 1, first + groups.count, all);
      out.push_back({make_cell(common, words), m, groups});
    }
  }
  return out;
}

void run_rival_cell(const RivalData& data, const std::vector<TimingModel>& models,
                    const stats::RivalComparisonOptions& options, const RivalCell& cell,
                    const std::filesystem::path& file) {
  write_shard(
      rival_shard_kind, fits_json(data, options), cell,
      [&] {
        Json out = Json::array();
        const auto model = rival_models(data, models).at(cell.model);
        for (const auto& fit : stats::fit_without_groups(model, data.answers, options, cell.groups))
          out.push_back(rival_fit_json(fit));
        return out;
      },
      file);
}

RivalFits join_rival_shards(const RivalData& data, const std::vector<TimingModel>& models,
                            const stats::RivalComparisonOptions& options,
                            const std::vector<std::filesystem::path>& files) {
  const auto cells = rival_cells(data, models, options);
  const auto all = static_cast<std::size_t>(stats::rival_group_count(data.answers.people, options));
  RivalFits out(rival_models(data, models).size(), {all, stats::Refusal{"not computed"}});
  read_shards(rival_shard_kind, fits_json(data, options), {cells.begin(), cells.end()}, files,
              [&](std::size_t at, const Json& outcomes) {
                const RivalCell& cell = cells[at];
                expect_size(outcomes, static_cast<std::size_t>(cell.groups.count));
                std::transform(outcomes.begin(), outcomes.end(), out[cell.model].begin() + cell.groups.first,
                               rival_fit_of);
              });
  return out;
}

}  // namespace study
