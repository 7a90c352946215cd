#include "libstudy/analysis/plan_file.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "libstudy/analysis/plan_comparison.hpp"
#include "libstudy/analysis/plan_hypotheses.hpp"
#include "libstudy/protocol/method_claims.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"
#include "stats/base/toml.hpp"

namespace study {

namespace {

constexpr std::size_t largest_plan = 1u << 20;
constexpr std::array timing_names{"none", "fail", "degraded"};
constexpr std::array repeated_names{"refuse", "warn", "share", "first"};
constexpr std::array decision_names{"intersection-union", "holm"};
constexpr std::array tests_names{"paired", "mixed"};

/// The number under `key`; empty if the key is "none", and `fallback` if the table lacks the key.
std::optional<double> optional_number(const base::TomlTable& table, const char* key,
                                      std::optional<double> fallback, base::Range range) {
  if (!table.has(key)) return fallback;
  if (!table.is_text(key)) return table.number(key, range);
  table.choice(key, {"none"});
  return {};
}

std::string number_or_none(const std::optional<double>& value) {
  return value ? base::shortest(*value) : "\"none\"";
}

template <class List>
std::size_t index_of_name(const List& names, const std::string& name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

void read_exclusions(const base::TomlTable& table, stats::ExclusionRules& rules) {
  constexpr base::Range share{0, 1};
  rules.timing = timing_rule_of(
      table.choice_or("timing", timing_rule_name(rules.timing), {timing_names.begin(), timing_names.end()}));
  rules.min_catch_correct = optional_number(table, "min_catch_correct", rules.min_catch_correct, share);
  rules.max_repeat_difference =
      optional_number(table, "max_repeat_difference", rules.max_repeat_difference, base::non_negative);
  rules.min_repeat_agreement =
      optional_number(table, "min_repeat_agreement", rules.min_repeat_agreement, share);
  rules.straight_lining_answers = static_cast<int>(
      table.integer_or("straight_lining_answers", rules.straight_lining_answers, {0, 10000}));
  rules.min_answered = table.number_or("min_answered", rules.min_answered, share);
}

/// Text of the key `directional` for stats::Directional::Once: the ids of the hypotheses with once_one_sided,
/// which are the only ones tested one-sided; "" if the plan has none.
std::string as_once_frozen(const stats::AnalysisPlan& plan) {
  return ids_with(claims_in_force(plan), &stats::MethodClaim::once_one_sided);
}

/// A plan file with the key `protocols` was written by a preregistration. If it lacks `decision` or
/// `directional`, an older version of the program wrote it. Each missing key then has that version's rule:
/// Holm for `decision`, one-sided tests in hypotheses with once_one_sided alone for `directional`.
void read_decision(const base::TomlTable& root, stats::AnalysisPlan& plan) {
  const bool frozen = root.has("protocols");
  if (frozen && !root.has("decision")) plan.decision = stats::DecisionRule::Holm;
  if (frozen && !root.has("directional")) plan.directional = stats::Directional::Once;
  const auto* const fallback = decision_names[static_cast<std::size_t>(plan.decision)];
  const auto decision = root.choice_or("decision", fallback, {decision_names.begin(), decision_names.end()});
  plan.decision = static_cast<stats::DecisionRule>(index_of_name(decision_names, decision));
  const auto tests = root.choice_or("tests", "paired", {tests_names.begin(), tests_names.end()});
  plan.tests = static_cast<stats::ScoreTests>(index_of_name(tests_names, tests));
  if (!root.has("directional")) return;
  if (root.is_text("directional")) {
    const std::string once = as_once_frozen(plan);
    if (once.empty() || root.string("directional") != once)
      root.fail("directional", "is the text '" + root.string("directional") + "', which names no rule",
                "use true or false, without quotes" + (once.empty() ? "" : ", or \"" + once + "\""));
    plan.directional = stats::Directional::Once;
  } else {
    plan.directional = root.boolean("directional") ? stats::Directional::All : stats::Directional::None;
  }
}

Json directional_json(const stats::AnalysisPlan& plan) {
  const std::string once = plan.directional == stats::Directional::Once ? as_once_frozen(plan) : "";
  return once.empty() ? Json(plan.directional == stats::Directional::All) : Json(once);
}

stats::PilotRules read_pilot(const base::TomlTable& table) {
  stats::PilotRules rules;
  rules.exclude_reverse_coders = table.choice_or("reverse_coders", "keep", {"keep", "exclude"}) == "exclude";
  rules.model_drift = table.choice_or("drift", "keep", {"keep", "model"}) == "model";
  rules.model_lapses = table.choice_or("lapses", "keep", {"keep", "model"}) == "model";
  return rules;
}

stats::AnalysisPlan read_keys(const base::TomlTable& root, const std::string& file,
                              std::vector<std::string>& protocols, const Protocol* protocol) {
  stats::AnalysisPlan plan;
  if (!root.has("format"))
    root.fail("format", "is missing", "write format = 1 at the top of the plan, above its first [table]");
  root.integer("format", {1, 1});
  if (root.has("protocols")) protocols = root.strings("protocols");
  constexpr base::Range inside{1e-6, 0.499999};
  plan.alpha = root.number_or("alpha", plan.alpha, inside);
  const auto tables = root.tables("hypothesis");
  plan.claims = read_method_claims(tables);
  read_decision(root, plan);
  plan.confidence = root.number_or("confidence", plan.confidence, {0.5, 0.999999});
  plan.resamples = static_cast<int>(root.integer_or("resamples", plan.resamples, {100, 1000000}));
  plan.seed = static_cast<std::uint64_t>(
      root.integer_or("seed", static_cast<std::int64_t>(plan.seed), base::non_negative));
  const auto repeated = root.choice_or("more_than_one_trial", root.has("protocols") ? "refuse" : "share",
                                       {repeated_names.begin(), repeated_names.end()});
  plan.repeated_pairs = static_cast<stats::RepeatedPairs>(index_of_name(repeated_names, repeated));
  if (root.has("margins")) {
    const auto margins = root.table("margins");
    plan.margin_realism = margins.number_or("realism", plan.margin_realism, margin_range("realism"));
    plan.margin_sickness = margins.number_or("sickness", plan.margin_sickness, margin_range("sickness"));
  }
  if (root.has("exclusions")) read_exclusions(root.table("exclusions"), plan.exclusions);
  if (root.has("pilot")) plan.pilot = read_pilot(root.table("pilot"));
  if (root.has("levels")) {
    const auto levels = root.table("levels");
    for (const auto& question : levels.keys()) plan.levels[question] = levels.number(question);
  }
  plan.hypotheses = read_hypotheses(tables, plan.confidence, protocol);
  if (root.has("model_comparison"))
    plan.comparison = read_comparison(root.table("model_comparison"), file, protocol);
  return plan;
}

Json claim_json(const stats::MethodClaim& one) {
  return {{"id", one.id},
          {"text", one.text},
          {"task", "task" + std::to_string(one.task)},
          {"outcome", one.task == 1 ? Json(one.scores) : Json("choice")},
          {"compare", {one.a, one.b}},
          {"test", claim_test_word(one.kind)},
          {"kind", stats::kind_name(one.kind)},
          {"margin", one.margins.empty() ? Json() : Json(one.margins)},
          {"needs_gaze", one.needs_gaze}};
}

/// The file's [pilot] table as text; empty if all of the pilot's rules have their defaults.
std::string format_pilot(const stats::PilotRules& rules) {
  if (!rules.exclude_reverse_coders && !rules.model_drift && !rules.model_lapses) return "";
  return std::string("\n[pilot]\nreverse_coders = ") +
         (rules.exclude_reverse_coders ? "\"exclude\"" : "\"keep\"") +
         "   # who rates higher frame rates lower: keep or exclude\ndrift = " +
         (rules.model_drift ? "\"model\"" : "\"keep\"") +
         "              # of the scores over the session: keep, or model: taken off\nlapses = " +
         (rules.model_lapses ? "\"model\"" : "\"keep\"") +
         "             # to the lowest score: keep, or model: scores corrected by their rate\n";
}

std::string format_levels(const std::map<std::string, double>& levels) {
  std::string out = levels.empty()
                        ? ""
                        : "\n[levels]                        # scores at which a pilot's curve is fitted, by "
                          "question\n";
  for (const auto& [question, level] : levels) out += question + " = " + base::shortest(level) + "\n";
  return out;
}

}  // namespace

const char* timing_rule_name(stats::TimingRule rule) { return timing_names[static_cast<std::size_t>(rule)]; }

stats::TimingRule timing_rule_of(const std::string& name) {
  const auto at = index_of_name(timing_names, name);
  if (at == timing_names.size())
    throw base::Error("timing rule \"" + name + "\"", "does not exist", "use none, fail or degraded");
  return static_cast<stats::TimingRule>(at);
}

PlanInForce read_plan(const std::filesystem::path& file, const Protocol* protocol) {
  const std::string text = base::read_file(file, largest_plan);
  const auto root = base::parse_toml(text, file.string());
  PlanInForce out;
  out.plan = read_keys(root, file.string(), out.protocols, protocol);
  root.finish();
  out.source = file.filename().string();
  out.sha256 = base::sha256_hex(text);
  return out;
}

std::string format_plan(const stats::AnalysisPlan& plan, const std::vector<std::string>& protocols) {
  const auto& rules = plan.exclusions;
  std::string list;
  for (const auto& one : protocols) list += (list.empty() ? "" : ", ") + base::toml_quoted(one);
  const std::string scores = ids_in_short(ids_of(claims_of_task(claims_in_force(plan), 1)));
  return "format = 1\nprotocols = [" + list +
         "]                # SHA-256 of the protocols\nalpha = " + base::shortest(plan.alpha) +
         "                    # of each claim\ndecision = \"" +
         decision_names[static_cast<std::size_t>(plan.decision)] +
         "\"  # a claim needs all of its tests, each at alpha; or \"holm\": each after Holm\ndirectional = " +
         directional_json(plan).dump() + "             # true: tests are one-sided\ntests = \"" +
         tests_names[static_cast<std::size_t>(plan.tests)] + "\"                # of " +
         (scores.empty() ? "ratings" : scores) +
         ": paired t tests, or the \"mixed\" model of all answers\nconfidence "
         "= " +
         base::shortest(plan.confidence) +
         "               # of intervals\nresamples = " + std::to_string(plan.resamples) +
         "               # of BCa intervals\nseed = " + std::to_string(plan.seed) +
         "\nmore_than_one_trial = \"" + repeated_names[static_cast<std::size_t>(plan.repeated_pairs)] +
         "\"  # a participant with several answers to one pair: share, first, refuse or warn\n\n[margins]    "
         "              "
         "     # points on "
         "the scale\nrealism = " +
         base::shortest(plan.margin_realism) + "\nsickness = " + base::shortest(plan.margin_sickness) +
         "\n\n[exclusions]\ntiming = \"" + timing_rule_name(rules.timing) +
         "\"                 # verdicts that exclude a trial: none, fail or degraded (and "
         "fail)\nmin_catch_correct = " +
         number_or_none(rules.min_catch_correct) +
         "         # share of catch pages\nmax_repeat_difference = " +
         number_or_none(rules.max_repeat_difference) +
         "       # points, mean over repeated showings\nmin_repeat_agreement = " +
         number_or_none(rules.min_repeat_agreement) +
         "   # share of repeated pairs answered alike\nstraight_lining_answers = " +
         std::to_string(rules.straight_lining_answers) +
         "     # one and the same answer to so many trials and all; 0: no such rule\nmin_answered = " +
         base::shortest(rules.min_answered) + "                # share of a visit's trials\n" +
         format_pilot(plan.pilot) + format_levels(plan.levels) + format_method_claims(plan.claims) +
         (plan.comparison ? format_comparison(*plan.comparison) : "") + format_hypotheses(plan.hypotheses);
}

Json plan_json(const PlanInForce& in_force, const std::vector<std::string>& protocols) {
  const auto& plan = in_force.plan;
  const auto& rules = plan.exclusions;
  const bool registered =
      !protocols.empty() && std::all_of(protocols.begin(), protocols.end(), [&](const std::string& sha256) {
        return std::find(in_force.protocols.begin(), in_force.protocols.end(), sha256) !=
               in_force.protocols.end();
      });
  Json json{{"source", in_force.source},
            {"sha256", in_force.sha256.empty() ? Json() : Json(in_force.sha256)},
            {"preregistered", registered},
            {"alpha", plan.alpha},
            {"decision", decision_names[static_cast<std::size_t>(plan.decision)]},
            {"directional", directional_json(plan)},
            {"tests", tests_names[static_cast<std::size_t>(plan.tests)]},
            {"confidence", plan.confidence},
            {"margins", {{"realism", plan.margin_realism}, {"sickness", plan.margin_sickness}}},
            {"exclusions",
             {{"timing", timing_rule_name(rules.timing)},
              {"min_catch_correct", rules.min_catch_correct},
              {"max_repeat_difference", rules.max_repeat_difference},
              {"min_repeat_agreement", rules.min_repeat_agreement},
              {"straight_lining_answers", rules.straight_lining_answers},
              {"min_answered", rules.min_answered}}},
            {"more_than_one_trial", repeated_names[static_cast<std::size_t>(plan.repeated_pairs)]},
            {"resamples", plan.resamples},
            {"seed", plan.seed}};
  if (!plan.levels.empty()) json["levels"] = plan.levels;
  for (const auto& one : plan.claims) json["hypotheses"].push_back(claim_json(one));
  for (const auto& one : plan.hypotheses) json["hypotheses"].push_back(declared_json(one));
  if (plan.comparison) json["model_comparison"] = comparison_json(*plan.comparison);
  if (!format_pilot(plan.pilot).empty())
    json["pilot"] = {{"reverse_coders", plan.pilot.exclude_reverse_coders ? "exclude" : "keep"},
                     {"drift", plan.pilot.model_drift ? "model" : "keep"},
                     {"lapses", plan.pilot.model_lapses ? "model" : "keep"}};
  return json;
}

Json preregistration_json(const FrozenFacts& frozen, const TaskData& data) {
  Json problems = Json::array();
  if (!frozen.altered.empty())
    problems.push_back("files of the bundle were altered: " + base::joined(frozen.altered));
  if (std::count(frozen.protocols.begin(), frozen.protocols.end(), data.protocol.sha256) == 0)
    problems.push_back("the bundle holds another protocol");
  if (!data.imported.empty())
    problems.push_back("answers were imported, and only their source says when they were given");
  if (!data.doubtful_times.empty())
    problems.push_back("the clock of a session is in doubt");
  else if (!data.first_answer_utc.empty() && frozen.frozen_utc >= data.first_answer_utc)
    problems.push_back("the bundle, frozen " + frozen.frozen_utc +
                       ", is not older than the first answer, given " + data.first_answer_utc);
  const bool holds = problems.empty();
  return {{"sha256", frozen.sha256},
          {"frozen_utc", frozen.frozen_utc},
          {"preregistered", holds},
          {"problems", problems}};
}

}  // namespace study
