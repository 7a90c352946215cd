#include "libstudy/analysis/plan_hypotheses.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "libstudy/protocol/readers.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

using stats::DeclaredHypothesis;
using stats::TestKind;

constexpr std::array adjust_words{"none", "bonferroni", "holm", "benjamini_hochberg"};

const char* adjust_word(stats::Adjustment adjust) { return adjust_words[static_cast<std::size_t>(adjust)]; }

bool is_one_of_two(TestKind kind) { return !stats::of_groups(kind) && !stats::of_answers(kind); }

std::vector<std::string> factor_names(const Design& design) {
  std::vector<std::string> out;
  for (const DesignFactor& factor : design.factors) out.push_back(factor.name);
  return out;
}

std::size_t factor_index(const Design& design, const std::string& name) {
  const auto names = factor_names(design);
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

/// The questions that the trials ask and whose answers have scores.
std::vector<const Question*> scored_questions(const Protocol& protocol) {
  std::vector<std::string> asked;
  for (const Block& block : protocol.blocks)
    for (const TrialStep& step : block.steps) asked.insert(asked.end(), step.asks.begin(), step.asks.end());
  std::vector<const Question*> out;
  for (const auto& [block, question] : all_questions(protocol))
    if (traits_of(question->kind).scored && std::count(asked.begin(), asked.end(), question->id) > 0)
      out.push_back(question);
  return out;
}

void read_test(const base::TomlTable& table, double confidence, DeclaredHypothesis& out) {
  out.test.kind = stats::test_of(table.choice("test", stats::test_words()));
  out.test.alternative =
      stats::alternative_of(table.choice_or("alternative", "two-sided", {"two-sided", "less", "greater"}));
  out.test.confidence = table.number_or("confidence", confidence, {0.500001, 0.999999});
  if (table.has("margin")) out.test.margin = table.number("margin", base::positive);
  const bool one_sided = out.test.alternative != stats::Alternative::TwoSided;
  if (out.test.kind == TestKind::Tost) {
    if (!out.test.margin)
      table.fail("test", "= \"tost\" needs a margin", "write margin, in the unit of the outcome");
    if (one_sided)
      table.fail("alternative", "does not apply to an equivalence test", "remove it: both sides are tested");
  } else if (out.test.margin) {
    if (out.test.kind != TestKind::PairedT && !stats::of_groups(out.test.kind))
      table.fail("margin", "does not apply to this test",
                 "use test = \"tost\", or a t test with alternative = \"greater\" or \"less\"");
    if (!one_sided)
      table.fail("margin", "needs a side",
                 "write alternative = \"greater\" or \"less\", or use test = \"tost\"");
  }
}

using Tables = std::vector<base::TomlTable>;

void read_compare(const base::TomlTable& table, const Tables& compare, DeclaredHypothesis& out) {
  for (const base::TomlTable& one : compare) {
    DeclaredHypothesis::Levels levels;
    for (const std::string& factor : one.keys()) levels[factor] = text_of(one, factor);
    out.compare.push_back(std::move(levels));
  }
  if (out.compare.size() != 1 && out.compare.size() != 2)
    table.fail("compare", "holds " + std::to_string(out.compare.size()) + " tables",
               "write two, such as compare = [{factor = \"a\"}, {factor = \"b\"}], or one and against");
  if (out.compare.size() == 1) {
    if (!is_one_of_two(out.test.kind))
      table.fail("compare", "names one condition, which this test cannot compare with a number",
                 "use test = \"paired_t\", \"wilcoxon\", \"binomial\" or \"tost\"");
    if (table.has("against")) out.against = table.number("against");
    return;
  }
  if (table.has("against"))
    table.fail("against", "does not apply to a comparison of two conditions",
               "remove it, or name one condition in compare");
  const auto names = [](const DeclaredHypothesis::Levels& levels) {
    std::vector<std::string> keys;
    for (const auto& [factor, level] : levels) keys.push_back(factor);
    return keys;
  };
  if (names(out.compare[0]) != names(out.compare[1]))
    table.fail_at("compare", 1, "names other factors than the first table", "name the same factors in both");
  if (out.compare[0] == out.compare[1])
    table.fail_at("compare", 1, "is the same as the first table", "change the level of a factor");
}

DeclaredHypothesis read_hypothesis(const base::TomlTable& table, const Tables& compare, double confidence) {
  DeclaredHypothesis out;
  out.id = id_of(table, "id");
  if (table.has("text")) out.text = text_of(table, "text");
  out.outcome = text_of(table, "outcome");
  read_test(table, confidence, out);
  read_compare(table, compare, out);
  if (table.has("positive")) out.positive = static_cast<int>(table.integer("positive"));
  if (table.has("family")) out.family = id_of(table, "family");
  const auto adjust = table.choice_or("adjust", out.family.empty() ? "none" : "holm",
                                      {adjust_words.begin(), adjust_words.end()});
  if (out.family.empty() && adjust != "none")
    table.fail("adjust", "= " + base::toml_quoted(adjust) + " needs a family",
               "write family, with the same word in each hypothesis that is adjusted together");
  const auto* const found = std::find(adjust_words.begin(), adjust_words.end(), adjust);
  out.adjust = static_cast<stats::Adjustment>(found - adjust_words.begin());
  return out;
}

void check_threshold(const base::TomlTable& table, const Protocol& protocol, const DeclaredHypothesis& one) {
  const Design& design = protocol.design;
  if (design.procedure->kind == ProcedureKind::Ptpe)
    table.fail("outcome", "= \"threshold\" is not estimated by the procedure ptpe", "use another procedure");
  const std::string& adaptive = design.factors[design.procedure->factor].name;
  if (one.compare.front().contains(adaptive))
    table.fail("compare", "names the factor " + base::toml_quoted(adaptive) + " of the procedure",
               "remove it: a threshold is estimated over all its levels");
  if (stats::of_answers(one.test.kind))
    table.fail("test", "models single answers, but a participant has one threshold",
               "use a test of one value of each participant, such as \"paired_t\" or \"welch_t\"");
}

const Question& outcome_question(const base::TomlTable& table, const Protocol& protocol,
                                 const DeclaredHypothesis& one) {
  const auto questions = scored_questions(protocol);
  std::vector<std::string> ids;
  for (const Question* question : questions) {
    if (question->id == one.outcome) return *question;
    ids.push_back(question->id);
  }
  if (protocol.design.procedure) ids.emplace_back(stats::threshold_outcome);
  table.fail(
      "outcome",
      "= " + base::toml_quoted(one.outcome) + " is not the id of a question with scores that the trials ask",
      base::use_one_of(one.outcome, ids));
}

void check_choice(const base::TomlTable& table, const Design& design, const Question& question,
                  const DeclaredHypothesis& one) {
  const OutcomeValue value = value_of(design, question);
  if (one.positive && value != OutcomeValue::Share)
    table.fail("positive", "does not apply to this outcome", "remove it");
  if (value == OutcomeValue::Share) {
    const auto score = positive_score(question, one.positive);
    if (!score)
      table.fail("outcome", "= " + base::toml_quoted(one.outcome) + " has more than two choices",
                 "write positive, the score whose share is compared");
    if (!can_be_given(question, *score))
      table.fail("positive", "= " + std::to_string(*score) + " is no answer to the question",
                 "use a score of its anchors");
  }
  if (value != OutcomeValue::Mean && one.test.kind == TestKind::LinearMixed)
    table.fail("test", "= \"mixed\" needs scores, but the outcome is a choice",
               "use \"clmm\", the logistic mixed model of a choice");
  if (one.compare.size() == 1 && !one.against && value != OutcomeValue::Comparison)
    table.fail("compare", "names one condition and no number to compare it with",
               "write against, or a second condition");
}

/// Refuses a margin that no difference of the outcome can exceed, since every result would be within it, and
/// a number that the outcome can never have.
void check_numbers(const base::TomlTable& table, const Design& design, const Question& question,
                   const DeclaredHypothesis& one) {
  const bool scores = value_of(design, question) == OutcomeValue::Mean;
  const double least = scores ? question.scale_min : 0, most = scores ? question.scale_max : 1;
  if (one.test.margin && *one.test.margin >= most - least)
    table.fail("margin",
               "= " + base::shortest(*one.test.margin) + " is as wide as the outcome, which has a range of " +
                   base::shortest(most - least) + ": every difference is within it",
               "write a smaller margin");
  if (one.against && (*one.against < least || *one.against > most))
    table.fail("against",
               "= " + base::shortest(*one.against) + " is no value of the outcome, which lies between " +
                   base::shortest(least) + " and " + base::shortest(most),
               "write a value between these");
}

void check_levels(const base::TomlTable& table, const Tables& tables, const Design& design,
                  const DeclaredHypothesis& one) {
  for (std::size_t i = 0; i < tables.size(); ++i) {
    for (const auto& [name, level] : one.compare[i]) {
      const std::size_t factor = factor_index(design, name);
      if (factor == design.factors.size())
        tables[i].fail(name, "is no factor of the protocol", base::use_one_of(name, factor_names(design)));
      const auto& levels = design.factors[factor].levels;
      if (std::find(levels.begin(), levels.end(), level) == levels.end())
        tables[i].fail(name, "= " + base::toml_quoted(level) + " is no level of this factor",
                       base::use_one_of(level, levels));
    }
    if (cells_with(design, one.compare[i]).empty())
      table.fail_at("compare", i,
                    design.standard ? "matches no cell that is compared with the standard"
                                    : "matches no cell of the design",
                    design.standard ? "name levels that the protocol combines, and not those of the standard"
                                    : "name levels that the protocol combines");
  }
  const bool groups = compares_groups(design, one);
  if (groups && is_one_of_two(one.test.kind) && one.compare.size() == 2)
    table.fail("test", "compares values of one participant, but different people see the two conditions",
               "use \"welch_t\", \"student_t\", \"mixed\" or \"clmm\"");
  if (!groups && stats::of_groups(one.test.kind))
    table.fail("test", "compares different people, but each participant sees both conditions",
               "use \"paired_t\", \"wilcoxon\", \"binomial\", \"tost\", \"mixed\" or \"clmm\"");
}

void check_fits(const base::TomlTable& table, const Tables& compare, const Protocol& protocol,
                const DeclaredHypothesis& one) {
  const Design& design = protocol.design;
  if (design.factors.empty())
    table.fail(
        "id", "= " + base::toml_quoted(one.id) + " is about a protocol without [[factor]]",
        "add task = \"task1\" or \"task2\" for a hypothesis about methods; or give a protocol of format "
        "3, or remove the hypothesis");
  if (design.pairs && !design.standard)
    table.fail("id", "= " + base::toml_quoted(one.id) + " is about pairs without a standard",
               "write standard in the protocol's [design], or remove the hypothesis");
  if (design.procedure && one.outcome == stats::threshold_outcome) {
    check_threshold(table, protocol, one);
    check_levels(table, compare, design, one);
    if (one.compare.size() == 1 && !one.against)
      table.fail("compare", "names one condition and no number to compare it with",
                 "write against, or a second condition");
    return;
  }
  const Question& question = outcome_question(table, protocol, one);
  if (design.procedure && question.id == design.procedure->question)
    table.fail("outcome", "= " + base::toml_quoted(one.outcome) + " steers the procedure",
               design.procedure->kind == ProcedureKind::Ptpe
                   ? "remove the hypothesis: vip-stats fit-ptpe fits the curve of these answers"
                   : "use \"threshold\": the procedure chooses the levels that are answered about");
  check_levels(table, compare, design, one);
  check_choice(table, design, question, one);
  check_numbers(table, design, question, one);
}

std::string levels_toml(const DeclaredHypothesis::Levels& levels) {
  std::string out;
  for (const auto& [factor, level] : levels)
    out += (out.empty() ? "" : ", ") + factor + " = " + base::toml_quoted(level);
  return "{" + out + "}";
}

}  // namespace

const char* outcome_word(OutcomeValue value) {
  constexpr std::array words{"mean", "share", "comparison", "threshold"};
  return words[static_cast<std::size_t>(value)];
}

OutcomeValue value_of(const Design& design, const Question& question) {
  if (!traits_of(question.kind).labelled) return OutcomeValue::Mean;
  return design.standard && question.anchors.size() == 2 ? OutcomeValue::Comparison : OutcomeValue::Share;
}

std::optional<int> positive_score(const Question& question, std::optional<int> declared) {
  if (!traits_of(question.kind).labelled) return {};
  if (declared || question.anchors.size() != 2) return declared;
  return question.anchors.back().first;
}

bool compares_groups(const Design& design, const stats::DeclaredHypothesis& hypothesis) {
  if (hypothesis.compare.size() < 2) return false;
  return std::ranges::any_of(design.factors, [&](const DesignFactor& factor) {
    const auto a = hypothesis.compare[0].find(factor.name), b = hypothesis.compare[1].find(factor.name);
    return factor.between && a != hypothesis.compare[0].end() && b != hypothesis.compare[1].end() &&
           a->second != b->second;
  });
}

std::vector<int> cells_with(const Design& design, const stats::DeclaredHypothesis::Levels& levels) {
  std::vector<int> out;
  for (std::size_t i = 0; i < design.cells.size(); ++i) {
    const Cell& cell = design.cells[i];
    const bool has_levels = std::ranges::all_of(levels, [&](const auto& one) {
      return level_name(design, cell, factor_index(design, one.first)) == one.second;
    });
    if (has_levels && !(design.standard && is_standard(design, cell))) out.push_back(static_cast<int>(i));
  }
  return out;
}

std::vector<stats::DeclaredHypothesis> read_hypotheses(const std::vector<base::TomlTable>& tables,
                                                       double confidence, const Protocol* protocol) {
  std::vector<DeclaredHypothesis> out;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    if (tables[i].has("task")) continue;
    // Each call of tables() makes new tables, and a key that is not looked up in every one of them is
    // reported as unknown. So "compare" is read with a single call.
    const Tables compare = tables[i].tables("compare");
    DeclaredHypothesis one = read_hypothesis(tables[i], compare, confidence);
    for (const DeclaredHypothesis& other : out) {
      if (other.id == one.id)
        tables[i].fail("id", "= " + base::toml_quoted(one.id) + " is the id of another hypothesis",
                       "use another id");
      if (!one.family.empty() && other.family == one.family && other.adjust != one.adjust)
        tables[i].fail("family", "= " + base::toml_quoted(one.family) + " is adjusted in another way above",
                       "write the same adjust in each hypothesis of the family");
    }
    if (protocol) check_fits(tables[i], compare, *protocol, one);
    out.push_back(std::move(one));
  }
  return out;
}

std::string format_hypotheses(const std::vector<stats::DeclaredHypothesis>& hypotheses) {
  std::string out;
  for (const DeclaredHypothesis& one : hypotheses) {
    out += "\n[[hypothesis]]\nid = " + base::toml_quoted(one.id) + "\n";
    if (!one.text.empty()) out += "text = " + base::toml_quoted(one.text) + "\n";
    out += "outcome = " + base::toml_quoted(one.outcome) + "\ncompare = [" + levels_toml(one.compare.front());
    if (one.compare.size() > 1) out += ", " + levels_toml(one.compare.back());
    out += "]\n";
    if (one.against) out += "against = " + base::shortest(*one.against) + "\n";
    if (one.positive) out += "positive = " + std::to_string(*one.positive) + "\n";
    out += "test = \"" + std::string(stats::test_word(one.test.kind)) + "\"\n";
    if (one.test.kind != TestKind::Tost)
      out += "alternative = \"" + std::string(stats::alternative_word(one.test.alternative)) + "\"\n";
    if (one.test.margin) out += "margin = " + base::shortest(*one.test.margin) + "\n";
    out += "confidence = " + base::shortest(one.test.confidence) + "\n";
    if (!one.family.empty())
      out += "family = " + base::toml_quoted(one.family) + "\nadjust = \"" + adjust_word(one.adjust) + "\"\n";
  }
  return out;
}

std::string condition_text(const stats::DeclaredHypothesis::Levels& levels) {
  std::string out;
  for (const auto& [factor, level] : levels) out += (out.empty() ? "" : ", ") + factor + " " + level;
  return out.empty() ? "all cells" : out;
}

std::string test_title(const stats::DeclaredHypothesis& one) {
  return one.compare.size() == 1 && one.test.kind == TestKind::PairedT ? "one-sample t test"
                                                                       : stats::test_name(one.test.kind);
}

std::string declared_text(const stats::DeclaredHypothesis& one) {
  std::string out = one.id + ": " + one.outcome + ", " + condition_text(one.compare.front());
  if (one.compare.size() > 1) out += " against " + condition_text(one.compare.back());
  if (one.against) out += " against " + base::shortest(*one.against);
  out += ", " + test_title(one);
  if (one.test.kind != TestKind::Tost)
    out += std::string(", ") + stats::alternative_word(one.test.alternative);
  if (one.test.margin) out += ", margin " + base::shortest(*one.test.margin);
  if (!one.family.empty())
    out += ", adjusted (" + std::string(adjust_word(one.adjust)) + ") in the family " + one.family;
  return out;
}

Json declared_json(const stats::DeclaredHypothesis& one) {
  return {{"id", one.id},
          {"text", one.text},
          {"outcome", one.outcome},
          {"compare", one.compare},
          {"against", one.against},
          {"positive", one.positive},
          {"test", stats::test_word(one.test.kind)},
          {"alternative",
           one.test.kind == TestKind::Tost ? Json() : Json(stats::alternative_word(one.test.alternative))},
          {"margin", one.test.margin},
          {"confidence", one.test.confidence},
          {"family", one.family.empty() ? Json() : Json(one.family)},
          {"adjust", adjust_word(one.adjust)}};
}

}  // namespace study
