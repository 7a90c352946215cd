#include "libstudy/power/worlds.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <array>

#include "libstudy/analysis/claims.hpp"
#include "libstudy/power/effect_levels.hpp"
#include "libstudy/protocol/method_claims.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

/// Methods from worst to best. The paper's hypotheses claim this order; LoRes, which they do not mention,
/// comes first.
constexpr std::array<const char*, 5> methods_by_rank{"LoRes", "FovFluid", "Ours", "Ours-TSp", "HiRes"};

/// Index of the method in methods_by_rank; -1 if it is not there.
int rank_of(const std::string& method) {
  const auto* const found = std::find(methods_by_rank.begin(), methods_by_rank.end(), method);
  return found == methods_by_rank.end() ? -1 : static_cast<int>(found - methods_by_rank.begin());
}

using stats::HypothesisKind;
using Qualities = std::array<double, 5>;  // one value for each method, in the order of methods_by_rank

constexpr double middle_of_realism = 4, middle_of_sickness = 1.5;

/// Scenario of Task 1. A method's mean realism is the middle of the scale plus its entry of `quality` (0 for
/// a method that methods_by_rank lacks) times unit_realism points. Its mean sickness is the middle of the
/// scale minus that entry times unit_sickness points.
Scenario by_quality(const ShownFactors& factors, std::vector<std::string> hypotheses,
                    const Qualities& quality, double unit_realism, double unit_sickness) {
  Scenario out{std::move(hypotheses), {}, {}, {}};
  for (std::size_t block = 0; block < factors.n_stars.size(); ++block) {
    for (const auto& method : factors.methods) {
      const int rank = rank_of(method);
      const double q = rank < 0 ? 0 : quality[static_cast<std::size_t>(rank)];
      out.realism.push_back(middle_of_realism + q * unit_realism);
      out.sickness.push_back(middle_of_sickness - q * unit_sickness);
    }
  }
  return out;
}

/// Assumed mean answers of the paper's Task 1. The paper prints no means for its Fig. 9, only the direction
/// of each significant difference. The means follow its text: Ours and Ours-TSp above FovFluid; Ours below
/// HiRes in realism; Ours-TSp above HiRes at 16k, slightly below HiRes and with more cybersickness at 32k;
/// Ours-TSp never below Ours in realism.
struct PaperMeans {
  const char* n_star;
  Qualities realism, sickness;
};
constexpr std::array<PaperMeans, 2> paper_means{
    {{"16k", {2.4, 3.5, 4.3, 5.0, 4.9}, {1.70, 1.40, 1.05, 0.90, 0.95}},
     {"32k", {2.6, 3.7, 4.6, 4.9, 5.2}, {1.60, 1.35, 1.00, 1.05, 0.85}}}};

Scenario paper_task1(const ShownFactors& factors, std::vector<std::string> hypotheses) {
  Scenario out{std::move(hypotheses), {}, {}, {}};
  for (const auto& n_star : factors.n_stars) {
    const auto* const means = std::find_if(paper_means.begin(), paper_means.end(),
                                           [&](const PaperMeans& one) { return n_star == one.n_star; });
    if (means == paper_means.end()) {
      throw base::Error("--world paper",
                        "the paper has results for n_* = 16k and 32k only, not for " + n_star,
                        "choose --world effect, null or margin, or a protocol with those n_*");
    }
    for (const auto& method : factors.methods) {
      const int rank = rank_of(method);
      out.realism.push_back(rank < 0 ? middle_of_realism : means->realism[static_cast<std::size_t>(rank)]);
      out.sickness.push_back(rank < 0 ? middle_of_sickness : means->sickness[static_cast<std::size_t>(rank)]);
    }
  }
  return out;
}

std::vector<std::string> ids_of_kinds(const MethodClaims& claims,
                                      std::initializer_list<HypothesisKind> kinds) {
  std::vector<std::string> out;
  for (const stats::MethodClaim& one : claims)
    if (std::find(kinds.begin(), kinds.end(), one.kind) != kinds.end()) out.push_back(one.id);
  return out;
}

/// "A's and B's".
std::string possessive(const std::vector<std::string>& ids) {
  std::string out;
  for (const std::string& id : ids) out += (out.empty() ? "" : " and ") + id + "'s";
  return out;
}

/// The differences of quality a - b, one for each method a and each method b that the claim compares.
std::vector<double> differences(const stats::MethodClaim& claim, const Qualities& quality) {
  const auto of = [&](const std::string& method) {
    const int rank = rank_of(method);
    return rank < 0 ? 0 : quality[static_cast<std::size_t>(rank)];
  };
  std::vector<double> out;
  for (const std::string& a : claim.a)
    for (const std::string& b : claim.b) out.push_back(of(a) - of(b));
  return out;
}

std::string words_of_null(const MethodClaims& claims) {
  const auto no = ids_of_kinds(claims, {HypothesisKind::Superiority}),
             yes = ids_of_kinds(claims, {HypothesisKind::Equivalence, HypothesisKind::NonInferiority});
  std::string out = "all methods are alike: ";
  if (!no.empty()) out += possessive(no) + " claims are false" + (yes.empty() ? "" : ", ");
  if (!yes.empty()) out += possessive(yes) + (no.empty() ? " claims are true" : " true");
  return out;
}

/// base::Error unless the world "margin" fits the claim. It fits if all differences of quality between the
/// claim's methods are 1 (superiority) or -1 (equivalence, non-inferiority), and if the claim's margins are
/// those of the plan.
void check_at_margin(const stats::MethodClaim& claim, const Qualities& quality,
                     const stats::AnalysisPlan& plan) {
  const double expected = claim.kind == HypothesisKind::Superiority ? 1 : -1;
  const auto found = differences(claim, quality);
  bool fits = std::all_of(found.begin(), found.end(), [&](double one) { return one == expected; });
  for (const auto& [score, margin] : claim.margins)
    fits = fits && margin == (score == "realism" ? plan.margin_realism : plan.margin_sickness);
  if (!fits)
    throw base::Error("--world margin", "is not made for the methods or margins of " + claim.id,
                      "choose --world null, effect or paper");
}

std::string words_of_margin(const MethodClaims& claims) {
  std::string better, worse;
  for (const stats::MethodClaim& one : claims) {
    std::string& out = one.kind == HypothesisKind::Superiority ? better : worse;
    out += out.empty() ? "" : " and ";
    const std::string b = base::joined(one.b);
    out += one.kind == HypothesisKind::Superiority   ? one.id + "'s methods better by it than " + b
           : one.kind == HypothesisKind::Equivalence ? one.id + "'s worse by it than " + b
                                                     : base::joined(one.a) + " worse by it than " + b;
  }
  if (worse.empty()) return better;
  return better + (better.empty() ? "" : "; ") + worse + ", so that " +
         possessive(ids_of_kinds(claims, {HypothesisKind::Equivalence, HypothesisKind::NonInferiority})) +
         " claims are just false";
}

/// Says in words which claims are true if the true differences between methods are positive multiples of the
/// differences of their qualities.
std::string words_of_effect(const MethodClaims& claims, const Qualities& quality) {
  std::vector<std::string> sure;
  for (const stats::MethodClaim& one : claims) {
    const auto found = differences(one, quality);
    const bool holds = std::all_of(found.begin(), found.end(), [&](double d) {
      return one.kind == HypothesisKind::Superiority   ? d > 0
             : one.kind == HypothesisKind::Equivalence ? d == 0
                                                       : d >= 0;
    });
    if (holds) sure.push_back(one.id);
  }
  if (sure.size() == claims.size()) return "all of " + base::joined(sure) + " are true";
  return "true whatever the margins: " + (sure.empty() ? "none" : base::joined(sure));
}

World task1_world(const PowerRequest& request, const ShownFactors& factors, const std::string& id) {
  const MethodClaims claims = claims_of_task(claims_in_force(request.plan.plan), 1);
  const auto all = ids_of(claims);
  if (id == "null") return {id, words_of_null(claims), {by_quality(factors, all, {}, 0, 0)}};
  if (id == "margin") {
    const double realism = request.plan.plan.margin_realism, sickness = request.plan.plan.margin_sickness;
    constexpr Qualities ours_between{-1, -1, 0, 0, 1}, accelerated_worse{-1, -1, 0, -1, 0};
    for (const stats::MethodClaim& claim : claims) {
      const bool naive = claim.kind == HypothesisKind::NonInferiority;
      check_at_margin(claim, naive ? accelerated_worse : ours_between, request.plan.plan);
    }
    return {
        id,
        fmt::format("differences of exactly the margin ({:.4g} on realism, {:.4g} on cybersickness): ",
                    realism, sickness) +
            words_of_margin(claims),
        {by_quality(factors, ids_of_kinds(claims, {HypothesisKind::Superiority, HypothesisKind::Equivalence}),
                    ours_between, realism, sickness),
         by_quality(factors, ids_of_kinds(claims, {HypothesisKind::NonInferiority}), accelerated_worse,
                    realism, sickness)}};
  }
  if (id == "paper") {
    return {id,
            "as the paper's words on its Fig. 9 can be read (it prints no means): see docs/statistics.md",
            {paper_task1(factors, all)}};
  }
  if (!request.effect && !request.difference) {
    throw base::Error("--world effect", "no effect was given",
                      "add --effect (in standard deviations of the differences) or --difference (points)");
  }
  const double d = request.effect ? *request.effect : *request.difference / request.sd_realism;
  constexpr Qualities fov_worse{-1, -1, 0, 0, 0};
  return {
      id,
      fmt::format(
          "Ours, Ours-TSp and HiRes alike, FovFluid worse by {:.4g} on realism and {:.4g} on cybersickness "
          "({:.4g} standard deviations of the differences): ",
          d * request.sd_realism, d * request.sd_sickness, d) +
          words_of_effect(claims, fov_worse),
      {by_quality(factors, all, fov_worse, d * request.sd_realism, d * request.sd_sickness)}};
}

/// Preferences in which the better of any two methods (methods_by_rank) is chosen with probability p.
std::vector<double> equal_preference(const ShownFactors& factors, double p) {
  std::vector<double> out;
  for (const auto& a : factors.methods) {
    for (const auto& b : factors.methods) {
      const int first = rank_of(a), second = rank_of(b);
      const bool known = first >= 0 && second >= 0 && first != second;
      out.push_back(!known ? 0.5 : first > second ? p : 1 - p);
    }
  }
  return out;
}

/// Number of the paper's 26 participants who chose a over b. The first two numbers follow from the p-values
/// in the paper (.029, .002), the others from its text on Fig. 10. For any other pair 19 of 26 are assumed to
/// choose the better method.
struct PaperPreference {
  const char *a, *b;
  int chosen;
};
constexpr std::array<PaperPreference, 5> paper_preferences{{{"Ours", "FovFluid", 19},
                                                            {"Ours-TSp", "FovFluid", 21},
                                                            {"Ours-TSp", "Ours", 14},
                                                            {"Ours", "HiRes", 12},
                                                            {"Ours-TSp", "HiRes", 15}}};

std::vector<double> paper_preference(const ShownFactors& factors) {
  constexpr double participants = 26;
  auto out = equal_preference(factors, paper_preferences[0].chosen / participants);
  const std::size_t count = factors.methods.size();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      for (const auto& known : paper_preferences) {
        if (factors.methods[i] != known.a || factors.methods[j] != known.b) continue;
        out[i * count + j] = known.chosen / participants;
        out[j * count + i] = 1 - known.chosen / participants;
      }
    }
  }
  return out;
}

World task2_world(const PowerRequest& request, const ShownFactors& factors, const std::string& id) {
  const auto ids = ids_of(claims_of_task(claims_in_force(request.plan.plan), 2));
  const auto world = [&](const std::string& words, std::vector<double> preferred) {
    return World{id, words, {{ids, {}, {}, std::move(preferred)}}};
  };
  if (id == "null")
    return world("every preference is .5: all claims are false", equal_preference(factors, 0.5));
  if (id == "margin") {
    return world("a test of preference has no margin: its boundary is .5, so this is the null",
                 equal_preference(factors, 0.5));
  }
  if (id == "paper") {
    return world(
        "as in the paper: 19 and 21 of 26 against FovFluid by its p-values; 14 of 26 for Ours-TSp "
        "over Ours, 12 and 15 of 26 for Ours and Ours-TSp over HiRes by its words",
        paper_preference(factors));
  }
  if (!request.effect) {
    throw base::Error("--world effect", "no effect was given",
                      "add --effect, the true preference of the better method, such as --effect 0.7");
  }
  return world(
      fmt::format("the better of two methods is chosen with probability {:.4g} (from worse to better: "
                  "LoRes, FovFluid, Ours, Ours-TSp, HiRes)",
                  *request.effect),
      equal_preference(factors, *request.effect));
}

}  // namespace

namespace {

/// Removes from the world the hypotheses about methods that the protocol does not show.
void keep_shown(World& world, const PowerRequest& request) {
  const auto shown = hypotheses_of(request.protocol, request.plan.plan).claims;
  for (Scenario& scenario : world.scenarios) {
    std::erase_if(scenario.hypotheses, [&](const std::string& id) {
      return std::none_of(shown.begin(), shown.end(), [&](const auto& one) { return one.id == id; });
    });
  }
  std::erase_if(world.scenarios, [](const Scenario& one) { return one.hypotheses.empty(); });
}

}  // namespace

std::vector<World> make_worlds(const PowerRequest& request, const ShownFactors& factors) {
  std::vector<World> out;
  for (const auto& id : request.worlds)
    out.push_back(!factors.effects.empty()        ? effect_world(request, factors, id)
                  : request.protocol.design.pairs ? task2_world(request, factors, id)
                                                  : task1_world(request, factors, id));
  if (factors.effects.empty())
    for (World& world : out) keep_shown(world, request);
  return out;
}

}  // namespace study
