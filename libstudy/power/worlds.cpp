#include "libstudy/power/worlds.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <array>

#include "libstudy/analysis/claims.hpp"
#include "libstudy/power/effect_levels.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

/// Methods from worst to best. H1 and H4 to H6 claim this order; LoRes, which they do not mention, comes
/// first.
constexpr std::array<const char*, 5> methods_by_rank{"LoRes", "FovFluid", "Ours", "Ours-TSp", "HiRes"};

/// Index of the method in methods_by_rank; -1 if it is not there.
int rank_of(const std::string& method) {
  const auto* const found = std::find(methods_by_rank.begin(), methods_by_rank.end(), method);
  return found == methods_by_rank.end() ? -1 : static_cast<int>(found - methods_by_rank.begin());
}

using Qualities = std::array<double, 5>;  // quality of each method in methods_by_rank

constexpr double middle_of_realism = 4, middle_of_sickness = 1.5;

/// Scenario of Task 1. A method's mean realism is the middle of the scale plus its quality times unit_realism
/// points. Its mean sickness is the middle of the scale minus its quality times unit_sickness points.
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

Scenario paper_task1(const ShownFactors& factors) {
  Scenario out{{"H1", "H2", "H3"}, {}, {}, {}};
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

World task1_world(const PowerRequest& request, const ShownFactors& factors, const std::string& id) {
  const std::vector<std::string> all{"H1", "H2", "H3"};
  if (id == "null") {
    return {id,
            "all methods are alike: H1's claims are false, H2's and H3's true",
            {by_quality(factors, all, {}, 0, 0)}};
  }
  if (id == "margin") {
    const double realism = request.plan.plan.margin_realism, sickness = request.plan.plan.margin_sickness;
    return {id,
            fmt::format("differences of exactly the margin ({:.4g} on realism, {:.4g} on cybersickness): "
                        "H1's methods better "
                        "by it than FovFluid; H2's worse by it than HiRes and Ours-TSp worse by it than "
                        "Ours, so that H2's "
                        "and H3's claims are just false",
                        realism, sickness),
            {by_quality(factors, {"H1", "H2"}, {-1, -1, 0, 0, 1}, realism, sickness),
             by_quality(factors, {"H3"}, {-1, -1, 0, -1, 0}, realism, sickness)}};
  }
  if (id == "paper") {
    return {id,
            "as the paper's words on its Fig. 9 can be read (it prints no means): see docs/statistics.md",
            {paper_task1(factors)}};
  }
  if (!request.effect && !request.difference) {
    throw base::Error("--world effect", "no effect was given",
                      "add --effect (in standard deviations of the differences) or --difference (points)");
  }
  const double d = request.effect ? *request.effect : *request.difference / request.sd_realism;
  return {
      id,
      fmt::format(
          "Ours, Ours-TSp and HiRes alike, FovFluid worse by {:.4g} on realism and {:.4g} on cybersickness "
          "({:.4g} standard deviations of the differences): all of H1, H2, H3 are true",
          d * request.sd_realism, d * request.sd_sickness, d),
      {by_quality(factors, all, {-1, -1, 0, 0, 0}, d * request.sd_realism, d * request.sd_sickness)}};
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
  const auto world = [&](const std::string& words, std::vector<double> preferred) {
    return World{id, words, {{{"H4", "H5", "H6"}, {}, {}, std::move(preferred)}}};
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
