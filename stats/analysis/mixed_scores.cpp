#include "stats/analysis/mixed_scores.hpp"

#include <algorithm>
#include <set>

namespace stats {

namespace {

std::string cell_name(int n_star, int method) {
  return "n_star" + std::to_string(n_star) + ":method" + std::to_string(method);
}

/// Adds an indicator column for each combination of n_* (nominal number of particles) and method that was
/// judged.
void add_cells(std::vector<Predictor>& terms, const std::vector<MethodScore>& answers) {
  std::set<std::pair<int, int>> cells;
  for (const auto& answer : answers) cells.insert({answer.n_star, answer.method});
  for (const auto& [n_star, method] : cells) {
    Predictor& term = terms.emplace_back();
    term.name = cell_name(n_star, method);
    for (const auto& answer : answers)
      term.values.push_back(answer.n_star == n_star && answer.method == method ? 1 : 0);
  }
}

/// Adds indicators of a factor's levels against its lowest level.
void add_factor(std::vector<Predictor>& terms, const std::string& name,
                const std::vector<MethodScore>& answers, int MethodScore::*factor) {
  std::vector<double> groups;
  for (const auto& answer : answers) groups.push_back(answer.*factor);
  if (groups.empty()) return;
  for (auto& term : indicators(name, groups, *std::min_element(groups.begin(), groups.end())))
    terms.push_back(std::move(term));
}

}  // namespace

std::vector<int> periods_of(std::span<const int> blocks) {
  std::vector<int> out;
  std::set<int> seen;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const bool begins = i == 0 || blocks[i] != blocks[i - 1];
    if (begins && !seen.insert(blocks[i]).second) return std::vector<int>(blocks.size(), 0);
    out.push_back(static_cast<int>(seen.size()) - 1);
  }
  return out;
}

Result<MixedContrast> MixedScores::difference(int n_star, int a, int b, double confidence) const {
  const int first = fit.index_of(cell_name(n_star, a)), second = fit.index_of(cell_name(n_star, b));
  if (first < 0 || second < 0) return Refusal{"no answer about one of the two methods"};
  std::vector<double> weights(fit.beta.size());
  weights[static_cast<std::size_t>(first)] = 1;
  weights[static_cast<std::size_t>(second)] = -1;
  return fit.contrast(weights, confidence);
}

Result<MixedScores> fit_mixed_scores(const ScoreTable& table) {
  const auto& answers = table.answers();
  std::vector<Predictor> terms;
  add_cells(terms, answers);
  add_factor(terms, "scene", answers, &MethodScore::scene);
  Predictor position{"position", {}};
  for (const auto& answer : answers) position.values.push_back(answer.position);
  terms.push_back(std::move(position));
  add_factor(terms, "period", answers, &MethodScore::period);
  std::vector<double> y;
  std::vector<int> participant, method;
  for (const auto& answer : answers) {
    y.push_back(answer.value());
    participant.push_back(answer.participant);
    method.push_back(answer.method);
  }
  const auto fit = fit_linear_mixed(y, terms, participant, method);
  if (!fit) return Refusal{fit.reason()};
  return MixedScores{*fit};
}

}  // namespace stats
