#include "libstudy/analysis/ptpe/fit_shards.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "libstudy/analysis/json_parts.hpp"
#include "stats/base/file.hpp"
#include "stats/base/program.hpp"

namespace study {

namespace {

constexpr ShardKind fit_shard_kind{"vip-stats fit-ptpe", "vip-fit-shard/1", "resamples", "the --resamples"};

/// Everything that a resample depends on, but for its number.
Json resamples_json(const FitRequest& request) {
  std::string ratings;
  for (const auto& one : request.data.ratings)
    ratings += fmt::format("{} {} {} {} {} {} {} {}\n", one.participant, one.mu, one.delta, one.realised_mu,
                           one.realised_mu_arithmetic, one.realised_delta, one.score, one.position);
  const auto& rules = request.rules;
  return {{"program", base::program_words()},
          {"protocol", request.data.protocol.sha256},
          {"question", request.data.question.id},
          {"scale", {request.data.question.scale_min, request.data.question.scale_max}},
          {"level", request.level},
          {"seed", request.bootstrap.seed},
          {"confidence", request.bootstrap.confidence},
          {"exclude_reverse_coders", rules.exclude_reverse_coders},
          {"model_drift", rules.model_drift},
          {"model_lapses", rules.model_lapses},
          {"data", base::sha256_hex(ratings)}};
}

Json resampled_json(const FitResamples& resamples) {
  Json out = Json::array();
  for (const auto& curves : resamples) {
    Json list = Json::array();
    for (const auto& curve : curves) list.push_back(json_interval(curve));
    out.push_back(std::move(list));
  }
  return out;
}

/// Reads what json_interval() wrote.
std::optional<std::array<double, 2>> resampled_curve_of(const Json& json) {
  if (json.is_null()) return std::nullopt;
  expect_size(json, 2);
  return std::array{number_of(json.at(std::size_t{0})), number_of(json.at(std::size_t{1}))};
}

void put_resamples(FitResamples& all, stats::ResampleRange range, int resamples, const Json& outcomes) {
  if (all.empty()) all.resize(outcomes.size());
  expect_size(outcomes, all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Json& list = outcomes.at(i);
    if (list.is_array() && list.empty()) continue;
    expect_size(list, static_cast<std::size_t>(range.count));
    all[i].resize(static_cast<std::size_t>(resamples));
    std::transform(list.begin(), list.end(), all[i].begin() + range.first, resampled_curve_of);
  }
}

}  // namespace

std::vector<FitCell> fit_cells(const FitRequest& request) {
  constexpr int drawn = 100000;
  const Json common = resamples_json(request);
  const int people = std::max(1, static_cast<int>(request.data.participants.size()));
  const int step = std::max(1, drawn / people), resamples = request.bootstrap.resamples;
  std::vector<FitCell> out;
  for (int first = 0; first < resamples; first += step) {
    const stats::ResampleRange range{first, std::min(step, resamples - first)};
    out.push_back(
        {make_cell(common, fmt::format("resamples {} to {}", first + 1, first + range.count)), range});
  }
  return out;
}

void run_fit_cell(const FitRequest& request, const FitCell& cell, const std::filesystem::path& file) {
  write_shard(
      fit_shard_kind, resamples_json(request), cell,
      [&] {
        return resampled_json(
            resample_fit(request.data, request.level, request.bootstrap, request.rules, cell.range));
      },
      file);
}

FitResamples join_fit_shards(const FitRequest& request, const std::vector<std::filesystem::path>& files) {
  const auto cells = fit_cells(request);
  FitResamples out;
  read_shards(fit_shard_kind, resamples_json(request), {cells.begin(), cells.end()}, files,
              [&](std::size_t at, const Json& outcomes) {
                put_resamples(out, cells[at].range, request.bootstrap.resamples, outcomes);
              });
  return out;
}

}  // namespace study
