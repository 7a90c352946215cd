#include "libstudy/preregistration/bundle_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "libstudy/analysis/claims.hpp"
#include "libstudy/analysis/plan_comparison.hpp"
#include "libstudy/analysis/plan_file.hpp"
#include "libstudy/analysis/plan_hypotheses.hpp"
#include "libstudy/protocol/method_claims.hpp"
#include "stats/base/file.hpp"
#include "stats/figures/svg.hpp"

namespace study::report {

namespace {

using Json = base::Json;

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

/// Lines for PREREGISTRATION.txt: for each curve that the protocol's pilot fits, the level and the scale.
std::string curves_text(const Protocol& protocol, const stats::AnalysisPlan& plan) {
  std::string out;
  for (const auto& question : curve_questions(protocol)) {
    out += "- " + protocol.name + ": the curve of question " + question.id + " is fitted at level " +
           fmt::format("{}", plan.levels.at(question.id)) + " of its scale, " +
           std::to_string(question.scale_min) + " to " + std::to_string(question.scale_max) + "\n";
  }
  return out;
}

bool has_block(const Protocol& protocol, BlockKind kind) {
  return std::any_of(protocol.blocks.begin(), protocol.blocks.end(),
                     [&](const Block& block) { return block.kind == kind; });
}

/// The largest possible difference between two ratings of a stimulus, over the protocol's scales except those
/// on sickness.
int widest_scale(const Protocol& protocol) {
  int out = 0;
  for (const auto& [block, question] : all_questions(protocol))
    if (traits_of(question->kind).rated() && !is_sickness(*question))
      out = std::max(out, question->scale_max - question->scale_min);
  return out;
}

/// For each key of the plan file that has no effect in any of the protocols, the reason why it has none.
std::map<std::string, std::string> idle_rules(const std::vector<Protocol>& protocols,
                                              const stats::AnalysisPlan& plan) {
  const auto none = [&](auto holds) { return std::none_of(protocols.begin(), protocols.end(), holds); };
  std::map<std::string, std::string> out;
  if (none([](const auto& one) { return compares_scores(one, {}); }))
    out["realism"] = "no ratings of realism compare methods";
  if (none([](const auto& one) { return compares_scores(one, items_without_unrealism); }))
    out["sickness"] = "no ratings of cybersickness compare methods";
  if (none([](const auto& one) { return one.design.timing != TimingSource::Native; }))
    out["timing"] = "without a schedule there is no verdict";
  if (none([](const auto& one) { return has_block(one, BlockKind::Catch); }))
    out["min_catch_correct"] = "there are no catch pages";
  const auto again = [](const auto& one) { return has_block(one, BlockKind::Repeat); };
  if (none([&](const auto& one) { return again(one) && one.design.pairs; }))
    out["min_repeat_agreement"] = "no pair is shown again";
  if (none([&](const auto& one) { return again(one) && !one.design.pairs; }))
    out["max_repeat_difference"] = "no rated stimulus is shown again";
  else if (none([&](const auto& one) {
             return again(one) && !one.design.pairs &&
                    plan.exclusions.max_repeat_difference.value_or(0) < widest_scale(one);
           }))
    out["max_repeat_difference"] = "no two ratings can differ by more";
  return out;
}

/// Comparison of the bundle's date with those first answers whose time contradicts the order of the
/// database's rows.
struct ByOrder {
  bool known = true;  ///< true if the bundle is known to be older than each of these answers
  std::string text;
};

/// The bundle counts as older if it is older than the answer's time. If the answer's time is impossible
/// (before ViP-Lab existed), the session's clock was wrong, and a bundle older than the rows that were
/// written before the answer counts as older too. If the time is possible, either this time or that of the
/// rows is wrong, so the times of the rows do not count.
ByOrder judge_by_order(const std::string& frozen, const Json& used) {
  ByOrder out;
  for (const Json& one : used.value("doubtful_times", Json::array())) {
    const std::string shown = one.at("told_utc"), least = one.at("not_before_utc"),
                      station = one.at("station");
    const bool by_clock = frozen < shown, by_order = one.at("impossible") == true && frozen < least;
    out.known = out.known && (by_clock || by_order);
    out.text += " The clock of " + (station.empty() ? "the station" : "station " + station) + " showed " +
                shown + " at the first answer of " + one.at("participant").text() +
                ", after rows of the database of " + least + ": ";
    out.text += by_clock   ? "the bundle is older than both."
                : by_order ? "that time is not possible, and by the order of the rows the bundle is older."
                           : "the two disagree, and whether the bundle is older cannot be told.";
  }
  return out;
}

}  // namespace

std::string frozen_plan(const std::vector<Protocol>& protocols, stats::AnalysisPlan plan) {
  // The hypotheses that ship with the programs are frozen too, because another version may ship others.
  if (std::any_of(protocols.begin(), protocols.end(),
                  [&](const Protocol& one) { return !hypotheses_of(one, plan).claims.empty(); }))
    plan.claims = claims_in_force(plan);
  std::vector<std::string> hashes;
  for (const auto& protocol : protocols) hashes.push_back(protocol.sha256);
  const auto idle = idle_rules(protocols, plan);
  std::istringstream lines(format_plan(plan, hashes));
  std::string out;
  for (std::string line; std::getline(lines, line);) {
    const auto found = idle.find(line.substr(0, line.find(" = ")));
    if (found != idle.end()) {
      const std::string rule = line.substr(0, line.find("  "));
      line = "# cannot act, as " + found->second + ": " + rule;
    }
    out += line + "\n";
  }
  return out;
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

std::string bundle_text(const std::vector<Protocol>& protocols, const stats::AnalysisPlan& plan,
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
  for (const auto& declared : plan.hypotheses) out += "- " + declared_text(declared) + "\n";
  if (plan.comparison) out += "- " + comparison_text(*plan.comparison) + "\n";
  if (hypotheses.empty() && plan.hypotheses.empty() && !plan.comparison) out += "None.\n";
  for (const std::string& one : untested) out += "- Not tested: " + one + ".\n";
  std::string curves;
  for (const auto& protocol : protocols) curves += curves_text(protocol, plan);
  if (!curves.empty()) out += "\nCurves\n" + curves;
  out += "\nMargins, level, exclusion rules and seed (plan.toml)\n" + frozen_plan(protocols, plan);
  if (with_power) out += "\nPower: power.json\n";
  return out +
         "\nTo check this folder: sha256sum -c MANIFEST.sha256\nThe bundle's hash is the SHA-256 of "
         "MANIFEST.sha256: deposit it where its date can be proved.\n";
}

Json time_json(const std::string& frozen, const Json& used) {
  const std::string title = used.at("title");
  const ByOrder order = judge_by_order(frozen, used);
  Json json{{"task", used.at("task")}};
  if (!used.at("first_answer_utc").is_string()) {
    json["frozen_before"] = order.text.empty() || !order.known ? Json() : Json(true);
    json["clocks_disagree"] = !order.text.empty();
    json["text"] =
        order.text.empty() ? "No time of an answer of " + title + " is recorded." : title + ":" + order.text;
    return json;
  }
  const std::string first = used.at("first_answer_utc");
  const bool simulated = used.value("simulated", 0) > 0, rehearsal = used.value("test_data", false);
  const bool before = frozen < first;
  json["first_answer_utc"] = first;
  json["frozen_before"] = before && !order.known ? Json() : Json(before);
  json["clocks_disagree"] = !order.text.empty();
  json["text"] = "The bundle was " + std::string(before ? "" : "not ") +
                 "frozen before the first answer of " + title + ", given " + first +
                 (simulated   ? " by an observer model."
                  : rehearsal ? " as test data."
                              : ".") +
                 order.text;
  if (used.contains("imported")) {
    if (before) json["frozen_before"] = Json();
    json["text"] = json["text"].get<std::string>() +
                   " These answers were imported: only their source says when they were given.";
  }
  return json;
}

}  // namespace study::report
