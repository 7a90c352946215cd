#include "libstudy/protocol/method_claims.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "libstudy/protocol/names.hpp"
#include "libstudy/protocol/readers.hpp"
#include "stats/base/file.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

using stats::HypothesisKind;
using stats::MethodClaim;

constexpr std::array holds_words{"significant", "not_significant", "not_worse"};
constexpr const char* choice_outcome = "choice";
constexpr const char* margin_of_plan = "plan";
constexpr std::size_t largest_file = 1u << 20;

std::vector<std::string> one_or_several(const base::TomlTable& table, const char* key) {
  auto out = table.is_list(key) ? table.strings(key) : std::vector{table.string(key)};
  if (out.empty()) table.fail(key, "is empty", "write at least one");
  for (std::size_t i = 1; i < out.size(); ++i)
    if (std::find(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(i), out[i]) !=
        out.begin() + static_cast<std::ptrdiff_t>(i))
      table.fail_at(key, i, "= " + base::toml_quoted(out[i]) + " is listed twice", "remove one");
  return out;
}

std::vector<std::string> read_methods(const base::TomlTable& table) {
  const auto out = one_or_several(table, "method");
  for (const std::string& method : out)
    if (!is_method(method))
      table.fail("method", "= " + base::toml_quoted(method) + " is no method",
                 base::use_one_of(method, method_names()));
  return out;
}

void read_methods_of(const base::TomlTable& table, MethodClaim& out) {
  const auto compare = table.tables("compare");
  if (compare.size() != 2)
    table.fail("compare", "holds " + std::to_string(compare.size()) + " tables",
               "write two, such as compare = [{method = \"Ours\"}, {method = \"HiRes\"}]");
  out.a = read_methods(compare[0]);
  out.b = read_methods(compare[1]);
  for (const std::string& method : out.b)
    if (std::find(out.a.begin(), out.a.end(), method) != out.a.end())
      table.fail_at("compare", 1, "compares " + method + " with itself", "name other methods in one of them");
}

void read_outcome(const base::TomlTable& table, MethodClaim& out) {
  const auto outcome = one_or_several(table, "outcome");
  const std::vector<std::string> known = out.task == 1 ? std::vector<std::string>{"realism", "sickness"}
                                                       : std::vector<std::string>{choice_outcome};
  for (const std::string& one : outcome)
    if (std::find(known.begin(), known.end(), one) == known.end())
      table.fail("outcome", "= " + base::toml_quoted(one) + " is no outcome of this task",
                 base::use_one_of(one, known));
  if (out.task == 1) out.scores = outcome;
}

void read_margin(const base::TomlTable& table, MethodClaim& out) {
  if (table.is_text("margin")) {
    table.choice("margin", {margin_of_plan});
    return;
  }
  const auto margins = table.table("margin");
  for (const std::string& score : out.scores) out.margins[score] = margins.number(score, margin_range(score));
}

void read_claim_test(const base::TomlTable& table, MethodClaim& out) {
  const bool choices = out.task == 2;
  const auto test = table.choice(
      "test", choices ? std::vector<std::string>{"binomial"} : std::vector<std::string>{"paired_t", "tost"});
  const bool equivalence = test == "tost", margin = table.has("margin");
  if (equivalence && !margin)
    table.fail("test", "= \"tost\" needs a margin", "write margin = \"plan\", or a number for each outcome");
  if (equivalence && table.has("alternative"))
    table.fail("alternative", "does not apply to an equivalence test", "remove it: both sides are tested");
  if (choices && margin) table.fail("margin", "does not apply to this test", "remove it");
  if (margin) read_margin(table, out);
  out.kind = choices       ? HypothesisKind::Preference
             : equivalence ? HypothesisKind::Equivalence
             : margin      ? HypothesisKind::NonInferiority
                           : HypothesisKind::Superiority;
  if (equivalence || table.choice("alternative", {"better", "worse"}) == "better") return;
  if (table.has("called"))
    table.fail("called", "names the methods that are chosen less often",
               "write compare the other way round, and alternative = \"better\"");
  // "a is worse than b" is the same claim as "b is better than a".
  std::swap(out.a, out.b);
}

MethodClaim::Paper read_paper(const base::TomlTable& table) {
  MethodClaim::Paper out;
  out.rule = text_of(table, "rule");
  const auto holds = table.choice("holds", {holds_words.begin(), holds_words.end()});
  const auto* const found = std::find(holds_words.begin(), holds_words.end(), holds);
  out.holds = static_cast<stats::PaperHolds>(found - holds_words.begin());
  out.published = text_of(table, "published");
  return out;
}

MethodClaim read_claim(const base::TomlTable& table) {
  MethodClaim out;
  out.id = id_of(table, "id");
  out.text = text_of(table, "text");
  out.task = table.choice("task", {"task1", "task2"}) == "task1" ? 1 : 2;
  read_outcome(table, out);
  read_methods_of(table, out);
  read_claim_test(table, out);
  out.needs_gaze = table.boolean_or("needs_gaze", false);
  out.once_one_sided = table.boolean_or("once_one_sided", false);
  if (out.task == 2) {
    out.larger_families = table.boolean_or("larger_families", false);
    if (table.has("called")) out.called = text_of(table, "called");
  }
  if (table.has("paper")) out.paper = read_paper(table.table("paper"));
  return out;
}

std::string words_toml(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + base::toml_quoted(word);
  return words.size() == 1 ? out : "[" + out + "]";
}

std::string margin_toml(const MethodClaim& claim) {
  std::string out;
  for (const auto& [score, margin] : claim.margins)
    out += (out.empty() ? "" : ", ") + score + " = " + base::shortest(margin);
  return out.empty() ? base::toml_quoted(margin_of_plan) : "{" + out + "}";
}

MethodClaims read_shipped() {
  const auto file = base::resource("protocols/plans/paper.toml");
  const auto root = base::parse_toml(base::read_file(file, largest_file), file.string());
  root.integer("format", {1, 1});
  const auto tables = root.tables("hypothesis");
  auto out = read_method_claims(tables);
  if (out.empty() || out.size() != tables.size())
    root.fail("", "lists a hypothesis without the key task, or no hypothesis",
              "write one [[hypothesis]] or more, each with task");
  root.finish();
  return out;
}

}  // namespace

const char* claim_test_word(HypothesisKind kind) {
  return kind == HypothesisKind::Preference    ? "binomial"
         : kind == HypothesisKind::Equivalence ? "tost"
                                               : "paired_t";
}

base::Range margin_range(const std::string& score) {
  // Realism is rated from 1 to 7, sickness from 0 to 3.
  const double below = score == "realism" ? 6 : 3;
  return {base::positive.min, std::nextafter(below, 0)};
}

MethodClaims read_method_claims(const std::vector<base::TomlTable>& tables) {
  MethodClaims out;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    if (!tables[i].has("task")) continue;
    out.push_back(read_claim(tables[i]));
    for (std::size_t j = 0; j < tables.size(); ++j)
      if (j != i && (j < i || !tables[j].has("task")) && tables[j].string_or("id", "") == out.back().id)
        tables[i].fail("id", "= " + base::toml_quoted(out.back().id) + " is the id of another hypothesis",
                       "use another id");
  }
  return out;
}

std::string format_method_claims(const MethodClaims& claims) {
  std::string out;
  for (const MethodClaim& one : claims) {
    const bool choices = one.task == 2;
    out += "\n[[hypothesis]]\nid = " + base::toml_quoted(one.id) + "\ntext = " + base::toml_quoted(one.text) +
           "\ntask = \"task" + std::to_string(one.task) +
           "\"\noutcome = " + (choices ? base::toml_quoted(choice_outcome) : words_toml(one.scores)) +
           "\ncompare = [{method = " + words_toml(one.a) + "}, {method = " + words_toml(one.b) +
           "}]\ntest = \"" + claim_test_word(one.kind) + "\"\n";
    if (one.kind != HypothesisKind::Equivalence) out += "alternative = \"better\"\n";
    if (one.kind == HypothesisKind::Equivalence || one.kind == HypothesisKind::NonInferiority)
      out += "margin = " + margin_toml(one) + "\n";
    if (one.needs_gaze) out += "needs_gaze = true\n";
    if (one.once_one_sided) out += "once_one_sided = true\n";
    if (one.larger_families) out += "larger_families = true\n";
    if (!one.called.empty()) out += "called = " + base::toml_quoted(one.called) + "\n";
    if (one.paper)
      out += "[hypothesis.paper]\nrule = " + base::toml_quoted(one.paper->rule) + "\nholds = \"" +
             holds_words[static_cast<std::size_t>(one.paper->holds)] +
             "\"\npublished = " + base::toml_quoted(one.paper->published) + "\n";
  }
  return out;
}

const MethodClaims& shipped_claims() {
  static const MethodClaims claims = read_shipped();
  return claims;
}

const MethodClaims& claims_in_force(const stats::AnalysisPlan& plan) {
  return plan.claims.empty() ? shipped_claims() : plan.claims;
}

MethodClaims claims_of_task(const MethodClaims& claims, int task) {
  MethodClaims out;
  std::copy_if(claims.begin(), claims.end(), std::back_inserter(out),
               [&](const MethodClaim& one) { return one.task == task; });
  return out;
}

std::string ids_in_short(const std::vector<std::string>& ids) {
  if (ids.size() < 3) return base::enumerated(ids);
  const std::string& first = ids.front();
  const std::string stem = first.substr(0, first.find_last_not_of("0123456789") + 1);
  const int number = stem.size() < first.size() ? std::atoi(first.c_str() + stem.size()) : -1;
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (number < 0 || ids[i] != stem + std::to_string(number + static_cast<int>(i)))
      return base::enumerated(ids);
  return first + " to " + ids.back();
}

std::vector<std::string> ids_of(const MethodClaims& claims) {
  std::vector<std::string> out;
  for (const MethodClaim& one : claims) out.push_back(one.id);
  return out;
}

std::string ids_with(const MethodClaims& claims, bool MethodClaim::*flag) {
  std::vector<std::string> ids;
  for (const MethodClaim& one : claims)
    if (one.*flag) ids.push_back(one.id);
  return base::enumerated(ids);
}

}  // namespace study
