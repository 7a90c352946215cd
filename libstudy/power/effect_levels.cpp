#include "libstudy/power/effect_levels.hpp"

#include <fmt/core.h>
#include <algorithm>

#include "stats/analysis/factor_levels.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

constexpr const char* id_of_claim = "effects";

std::size_t place_of(const std::vector<std::string>& list, const std::string& item) {
  return static_cast<std::size_t>(std::find(list.begin(), list.end(), item) - list.begin());
}

bool has_effects(const ShownFactors& factors, std::size_t treatment) {
  const int level = factors.treatments[treatment].level;
  return factors.effects[static_cast<std::size_t>(level)] != no_effects_level;
}

/// Probabilities that the row's treatment is chosen over the column's, row-major. A treatment with effects is
/// chosen over a treatment without effects with probability p. In any other pair, each treatment is chosen
/// with probability .5.
std::vector<double> preferring_effects(const ShownFactors& factors, double p) {
  const std::size_t count = factors.methods.size();
  std::vector<double> out;
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b < count; ++b) {
      const bool with = has_effects(factors, a);
      out.push_back(with == has_effects(factors, b) ? 0.5 : with ? p : 1 - p);
    }
  }
  return out;
}

/// The test that `level` is preferred over none. `none_first`: in `found`, a is none and b is the level.
stats::HypothesisTest test_of(const stats::LevelPreference& found, bool none_first, const std::string& level,
                              const stats::AnalysisPlan& plan) {
  stats::HypothesisTest out;
  out.label = level + " over " + no_effects_level;
  out.method = "t test";
  out.a = level;
  out.b = no_effects_level;
  out.n = static_cast<std::size_t>(found.participants);
  if (found.n > 0) out.estimate = 1.0 * (none_first ? found.n - found.k : found.k) / found.n;
  out.p = found.p();
  out.p_holm = found.p_holm;
  const bool better = out.estimate && *out.estimate > 0.5, worse = out.estimate && *out.estimate < 0.5;
  out.holds_alone = better && out.p && *out.p < plan.alpha;
  out.holds_holm = better && out.p_holm && *out.p_holm < plan.alpha;
  out.holds = plan.decision == stats::DecisionRule::Holm ? out.holds_holm : out.holds_alone;
  out.against = worse && out.p_holm && *out.p_holm < plan.alpha;
  return out;
}

void judge(stats::Hypothesis& claim) {
  for (const auto& test : claim.tests) {
    claim.confirmed += test.holds ? 1 : 0;
    claim.confirmed_holm += test.holds_holm ? 1 : 0;
  }
  claim.status = claim.confirmed == static_cast<int>(claim.tests.size()) ? stats::HypothesisStatus::Supported
                 : claim.confirmed_holm > 0 ? stats::HypothesisStatus::PartlySupported
                                            : stats::HypothesisStatus::NotSupported;
  claim.status_if_testable = claim.status;
}

}  // namespace

World effect_world(const PowerRequest& request, const ShownFactors& factors, const std::string& id) {
  const auto world = [&](const std::string& words, double p) {
    return World{id, words, {{{id_of_claim}, {}, {}, preferring_effects(factors, p)}}};
  };
  if (place_of(factors.effects, no_effects_level) == factors.effects.size()) {
    throw base::Error("protocol " + request.protocol.name,
                      "varies effects but lacks level none, with which power compares the other levels",
                      "simulate it: vip-study run with --observer, then vip-stats report");
  }
  if (id == "null") return world("every preference is .5: participants do not see what effects do", 0.5);
  if (id != "effect") {
    throw base::Error("--world " + id,
                      "cannot simulate effects, which protocol " + request.protocol.name + " varies",
                      "choose --world effect or null");
  }
  if (!request.effect) {
    throw base::Error("--world effect", "no effect was given",
                      "add --effect, the true preference for a level of effects over none, such as --effect "
                      "0.7");
  }
  return world(fmt::format("any level of effects is chosen over none with probability {:.4g}, whatever the "
                           "methods; nothing else is seen",
                           *request.effect),
               *request.effect);
}

stats::Hypothesis effect_hypothesis(std::span<const stats::PairChoice> choices, const ShownFactors& factors,
                                    const stats::AnalysisPlan& plan) {
  stats::Hypothesis out;
  out.id = id_of_claim;
  out.title = "each level of effects is preferred over none";
  out.task = 2;
  out.kind = stats::HypothesisKind::Preference;
  out.alpha = plan.alpha;
  out.decision = plan.decision;
  out.rule = "two-sided t tests of the participants' shares, of pairs that differ in nothing else";
  const std::size_t none = place_of(factors.effects, no_effects_level);
  for (const auto& found : stats::level_preferences(choices, factors.treatments,
                                                    static_cast<int>(factors.effects.size()), plan)) {
    const auto a = static_cast<std::size_t>(found.a), b = static_cast<std::size_t>(found.b);
    if (a == none || b == none)
      out.tests.push_back(test_of(found, a == none, factors.effects[a == none ? b : a], plan));
  }
  judge(out);
  return out;
}

double effect_truth(const Scenario& scenario, const ShownFactors& factors,
                    const stats::HypothesisTest& test) {
  const auto treatment = [&](const std::string& level) {
    const auto found = std::find_if(
        factors.treatments.begin(), factors.treatments.end(),
        [&](const auto& one) { return factors.effects[static_cast<std::size_t>(one.level)] == level; });
    return static_cast<std::size_t>(found - factors.treatments.begin());
  };
  return scenario.preferred[treatment(test.a) * factors.methods.size() + treatment(test.b)];
}

}  // namespace study
