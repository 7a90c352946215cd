#include "apps/stats/report/bundle_parts.hpp"

#include <fmt/format.h>

#include "apps/common/claims.hpp"
#include "apps/common/svg.hpp"
#include "apps/stats/data/plan_file.hpp"
#include "stats/base/file.hpp"

namespace apps::report {

namespace {

using Json = nlohmann::ordered_json;

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

/// A line for each curve.
std::string curves_text(const study::Protocol& protocol, const stats::AnalysisPlan& plan) {
  std::string out;
  for (const auto& question : curve_questions(protocol)) {
    out += "- " + protocol.name + ": the curve of question " + question.id + " is fitted at level " +
           fmt::format("{}", plan.levels.at(question.id)) + " of its scale, " +
           std::to_string(question.scale_min) + " to " + std::to_string(question.scale_max) + "\n";
  }
  return out;
}

}  // namespace

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
                        const Json& hypotheses, const std::vector<std::string>& untested, bool with_power,
                        const std::string& frozen_utc) {
  std::string out =
      "Preregistration, frozen " + frozen_utc + " with ViP-Lab " + base::version() + "\n\nProtocols\n";
  for (const auto& protocol : protocols)
    out += "- " + protocol.name + " version " + protocol.version + ", " +
           std::to_string(protocol.participants) + " participants planned\n  SHA-256 " + protocol.sha256 +
           "\n";
  out += "\nHypotheses\n";
  for (const Json& hypothesis : hypotheses) out += hypothesis_text(hypothesis);
  if (hypotheses.empty()) out += "None.\n";
  for (const std::string& one : untested) out += "- Not tested: " + one + ".\n";
  std::string curves;
  for (const auto& protocol : protocols) curves += curves_text(protocol, plan);
  if (!curves.empty()) out += "\nCurves\n" + curves;
  std::vector<std::string> hashes;
  for (const auto& protocol : protocols) hashes.push_back(protocol.sha256);
  out += "\nMargins, level, exclusion rules and seed (plan.toml)\n" + format_plan(plan, hashes);
  if (with_power) out += "\nPower: power.json\n";
  return out +
         "\nTo check this folder: sha256sum -c MANIFEST.sha256\nThe bundle's hash is the SHA-256 of "
         "MANIFEST.sha256: deposit it where its date can be proved.\n";
}

}  // namespace apps::report
