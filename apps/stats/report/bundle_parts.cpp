#include "apps/stats/report/bundle_parts.hpp"

#include <algorithm>

#include "apps/common/svg.hpp"
#include "apps/stats/data/plan_file.hpp"
#include "stats/base/file.hpp"

namespace apps::report {

namespace {

using Json = nlohmann::ordered_json;

void add_once(std::vector<std::string>& list, const std::string& item) {
  if (std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
}

std::string hypothesis_text(const Json& hypothesis) {
  std::string out = hypothesis.at("id").get<std::string>() + " (" + hypothesis.at("kind").get<std::string>() +
                    "). " + hypothesis.at("title").get<std::string>() +
                    "\n  Rule: " + hypothesis.at("rule").get<std::string>() +
                    "; alpha = " + svg::number(hypothesis.at("alpha").get<double>(), 3) + ".\n";
  for (const Json& test : hypothesis.at("tests")) {
    out += "  - " + test.at("label").get<std::string>();
    if (test.at("margin").is_number()) out += ", margin " + svg::number(test.at("margin").get<double>(), 3);
    out += "\n";
  }
  return out;
}

std::string no_hypotheses(const std::vector<study::Protocol>& protocols) {
  const bool pilots = std::all_of(protocols.begin(), protocols.end(), [](const study::Protocol& one) {
    return one.design.timing == study::TimingSource::Settings;
  });
  return pilots ? "None: the study estimates a and b of mu = a exp(b delta).\n"
                : "None: effects are a factor; H1 to H6 are about methods alone. What each level is worth is "
                  "exploratory.\n";
}

}  // namespace

std::vector<stats::Hypothesis> hypotheses_of(const study::Protocol& protocol,
                                             const stats::AnalysisPlan& plan) {
  // The paper's claims are about methods alone.
  if (protocol.design.timing == study::TimingSource::Settings || !protocol.design.effects.empty()) return {};
  std::vector<std::string> methods, n_stars;
  for (const auto& cell : protocol.design.cells) {
    add_once(methods, cell.stimulus.method);
    add_once(n_stars, cell.stimulus.n_star);
  }
  if (!protocol.design.pairs) {
    stats::ScoreScale realism, sickness;
    realism.code = "realism";
    realism.margin = plan.margin_realism;
    sickness.code = "sickness";
    sickness.margin = plan.margin_sickness;
    sickness.max = 3;
    sickness.min = 0;
    sickness.higher_is_better = false;
    return stats::task1_hypotheses({realism, {}, 0, n_stars, methods}, {sickness, {}, 0, n_stars, methods},
                                   plan, "");
  }
  std::vector<stats::PairPreference> pairs;
  for (int a = 0; a < static_cast<int>(methods.size()); ++a) {
    for (int b = a + 1; b < static_cast<int>(methods.size()); ++b) {
      pairs.emplace_back();
      pairs.back().a = a;
      pairs.back().b = b;
      pairs.back().test = stats::Refusal{"no data"};
    }
  }
  return stats::task2_hypotheses(pairs, methods, plan, "");
}

Json fixed_part(const Json& hypothesis) {
  Json out, tests = Json::array();
  for (const char* key : {"id", "title", "task", "kind", "family", "alpha", "rule"})
    out[key] = hypothesis.at(key);
  for (const Json& test : hypothesis.at("tests"))
    tests.push_back({{"label", test.at("label")},
                     {"a", test.at("a")},
                     {"b", test.at("b")},
                     {"margin", test.at("margin")}});
  out["tests"] = tests;
  return out;
}

std::string bundle_text(const std::vector<study::Protocol>& protocols, const stats::AnalysisPlan& plan,
                        const Json& hypotheses, bool with_power, const std::string& frozen_utc) {
  std::string out =
      "Preregistration, frozen " + frozen_utc + " with ViP-Lab " + base::version() + "\n\nProtocols\n";
  for (const auto& protocol : protocols)
    out += "- " + protocol.name + " version " + protocol.version + ", " +
           std::to_string(protocol.participants) + " participants planned\n  SHA-256 " + protocol.sha256 +
           "\n";
  out += "\nHypotheses\n";
  for (const Json& hypothesis : hypotheses) out += hypothesis_text(hypothesis);
  if (hypotheses.empty()) out += no_hypotheses(protocols);
  std::vector<std::string> hashes;
  for (const auto& protocol : protocols) hashes.push_back(protocol.sha256);
  out += "\nMargins, level, exclusion rules and seed (plan.toml)\n" + format_plan(plan, hashes);
  if (with_power) out += "\nPower: power.json\n";
  return out +
         "\nTo check this folder: sha256sum -c MANIFEST.sha256\nThe bundle's hash is the SHA-256 of "
         "MANIFEST.sha256: deposit it where its date can be proved.\n";
}

}  // namespace apps::report
