#include "libstudy/analysis/plan_comparison.hpp"

#include <algorithm>

#include "libstudy/analysis/timing_predictors.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

void check_question(const base::TomlTable& table, const std::string& id, const Protocol& protocol) {
  std::vector<std::string> rated;
  for (const auto& [place, question] : all_questions(protocol))
    if (const auto& traits = traits_of(question->kind); traits.rated() || traits.yes_no)
      rated.push_back(question->id);
  if (protocol.design.pairs)
    table.fail("question", "is compared in protocol " + protocol.name + ", which shows pairs",
               "remove [model_comparison]: models are compared on trials of one stimulus");
  if (std::find(rated.begin(), rated.end(), id) == rated.end())
    table.fail("question", "names no rating of protocol " + protocol.name + " and no yes or no",
               base::use_one_of(id, rated));
}

}  // namespace

stats::DeclaredComparison read_comparison(const base::TomlTable& table, const std::string& file,
                                          const Protocol* protocol) {
  stats::DeclaredComparison out;
  out.question = table.string("question");
  out.models = table.strings("models");
  timing_models(out.models, file + ", models of [model_comparison]");
  out.folds = static_cast<int>(table.integer_or("folds", 0, {0, 1000}));
  if (out.folds == 1) table.fail("folds", "leaves nobody to fit", "write 0, or 2 and more groups");
  out.expected = table.string_or("expected", "");
  if (!out.expected.empty() &&
      std::find(out.models.begin(), out.models.end(), out.expected) == out.models.end())
    table.fail("expected", "is none of the models", base::use_one_of(out.expected, out.models));
  if (protocol) {
    check_question(table, out.question, *protocol);
    if (out.folds > protocol->participants)
      table.fail("folds",
                 "is more than the " + std::to_string(protocol->participants) +
                     " participants that protocol " + protocol->name + " plans",
                 "write at most " + std::to_string(protocol->participants) +
                     ", or 0 to leave out each person in turn");
  }
  return out;
}

std::string format_comparison(const stats::DeclaredComparison& comparison) {
  std::string models;
  for (const std::string& one : comparison.models)
    models += (models.empty() ? "" : ", ") + base::toml_quoted(one);
  return "\n[model_comparison]              # what vip-stats compare-models compares\nquestion = " +
         base::toml_quoted(comparison.question) + "\nmodels = [" + models +
         "]\nfolds = " + std::to_string(comparison.folds) + "\n" +
         (comparison.expected.empty() ? "" : "expected = " + base::toml_quoted(comparison.expected) + "\n");
}

std::string comparison_text(const stats::DeclaredComparison& comparison) {
  return "comparison of the models " + base::enumerated(comparison.models) + " on the answers to '" +
         comparison.question + "'" +
         (comparison.expected.empty() ? "" : "; expected to predict best: " + comparison.expected);
}

Json comparison_json(const stats::DeclaredComparison& comparison) {
  return {{"question", comparison.question},
          {"models", comparison.models},
          {"folds", comparison.folds},
          {"expected", comparison.expected.empty() ? Json() : Json(comparison.expected)}};
}

}  // namespace study
