#pragma once
/// Small tables and made-up studies for tests of the analyses.

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "libstudy/protocol/method_claims.hpp"
#include "stats/analysis/hypotheses.hpp"
#include "stats/analysis/score_table.hpp"
#include "stats/analysis/task2.hpp"

namespace stats::test {

inline const std::vector<std::string> methods{"LoRes", "FovFluid", "Ours", "Ours-TSp", "HiRes"};
inline const std::vector<std::string> n_stars{"16k", "32k"};

inline ScoreScale realism_scale() { return {"realism", "Realism", true, 1, 7, true, {"realism"}, 0.5}; }
inline ScoreScale sickness_scale() { return {"sickness", "Cybersickness", true, 0, 3, false, {}, 0.25}; }

/// A table for one number of particles: one column for each method, one row for each participant.
inline ScoreTable table_of(const std::vector<std::vector<double>>& rows, std::vector<std::string> names,
                           ScoreScale scale = realism_scale()) {
  std::vector<MethodScore> scores;
  for (std::size_t p = 0; p < rows.size(); ++p) {
    for (std::size_t m = 0; m < rows[p].size(); ++m)
      scores.push_back({static_cast<int>(p), 0, 0, static_cast<int>(m), rows[p][m]});
  }
  return {std::move(scale), scores, static_cast<int>(rows.size()), {"16k"}, std::move(names)};
}

/// Scores of n participants at both numbers of particles: the method's mean, plus the participant's level,
/// plus noise.
inline ScoreTable normal_table(const std::vector<double>& means, double participant_sd, double noise, int n,
                               std::uint64_t seed, ScoreScale scale = realism_scale()) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<MethodScore> scores;
  for (int p = 0; p < n; ++p) {
    const double level = participant_sd * normal(generator);
    for (int block = 0; block < 2; ++block) {
      for (int m = 0; m < static_cast<int>(means.size()); ++m)
        scores.push_back(
            {p, block, block, m, means[static_cast<std::size_t>(m)] + level + noise * normal(generator)});
    }
  }
  return {std::move(scale), scores, n, n_stars, methods};
}

/// Adds n answers to the pair of a and b, each of another participant. The first k answers choose a. In every
/// other answer a was shown first.
inline void add_pair(std::vector<PairChoice>& choices, int a, int b, int k, int n) {
  for (int i = 0; i < n; ++i) {
    const bool a_first = i % 2 == 0, a_chosen = i < k;
    choices.push_back(
        {i, 0, a_first ? a : b, a_first ? b : a, a_first == a_chosen, static_cast<int>(choices.size()) % 10});
  }
}

}  // namespace stats::test

namespace stats {

/// The results for the hypotheses that ship with the programs.
inline std::vector<Hypothesis> task1_hypotheses(const ScoreTable& realism, const ScoreTable& sickness,
                                                const AnalysisPlan& plan, const std::string& untestable) {
  return task1_hypotheses(study::shipped_claims(), realism, sickness, plan, untestable);
}
inline std::vector<Hypothesis> task2_hypotheses(std::span<const PairPreference> pairs,
                                                const std::vector<std::string>& methods,
                                                const AnalysisPlan& plan, const std::string& untestable) {
  return task2_hypotheses(study::shipped_claims(), pairs, methods, plan, untestable);
}

}  // namespace stats
