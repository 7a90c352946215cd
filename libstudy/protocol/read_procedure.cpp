/// Reads [procedure] of format 3.
#include <algorithm>
#include <array>
#include <cmath>

#include "libstudy/protocol/readers.hpp"
#include "stats/base/nearest.hpp"
#include "stats/ptpe/placement.hpp"

namespace study {

namespace {

constexpr std::array procedure_words{"staircase", "quest_plus", "ptpe"};
constexpr base::Range track_range{1, 500};

/// The timing profile of the cells with this level of the factor; base::Error if they have different
/// profiles.
const TimingProfile& profile_of(const base::TomlTable& table, const Design& design, std::size_t factor,
                                int level) {
  const TimingProfile* found = nullptr;
  for (const Cell& cell : design.cells) {
    if (cell.levels[factor] != level) continue;
    if (found && *found != *cell.setting.profile)
      table.fail("factor", "has levels whose timing another factor changes",
                 "let this factor alone set the timing");
    found = cell.setting.profile.get();
  }
  return *found;
}

std::size_t read_factor_index(const base::TomlTable& table, const Design& design) {
  const std::string word = text_of(table, "factor");
  std::vector<std::string> names;
  for (const DesignFactor& factor : design.factors) names.push_back(factor.name);
  const auto found = std::find(names.begin(), names.end(), word);
  if (found == names.end())
    table.fail("factor", "= " + base::toml_quoted(word) + " is no factor", base::use_one_of(word, names));
  const auto index = static_cast<std::size_t>(found - names.begin());
  if (design.factors[index].between)
    table.fail("factor", "= " + base::toml_quoted(word) + " varies between participants",
               "name a factor with vary = \"within\"");
  return index;
}

void read_values(const base::TomlTable& table, const Design& design, Procedure& out) {
  out.axis = table.choice("axis", axis_keys());
  const auto count = static_cast<int>(design.factors[out.factor].levels.size());
  for (int level = 0; level < count; ++level) {
    const std::string& name = design.factors[out.factor].levels[static_cast<std::size_t>(level)];
    const auto value = axis_value(profile_of(table, design, out.factor, level), out.axis);
    if (!value)
      table.fail("axis", "= \"" + out.axis + "\" is no key of the timing of level " + base::toml_quoted(name),
                 "name a key that the timing of each level has");
    if (!out.values.empty() && *value <= out.values.back())
      table.fail("axis",
                 "= \"" + out.axis + "\" does not rise from level to level: " + base::toml_quoted(name) +
                     " has " + shown(*value) + " after " + shown(out.values.back()),
                 "list the levels by ascending " + out.axis);
    out.values.push_back(*value);
  }
}

void read_positive(const base::TomlTable& table, const Design& design, Procedure& out) {
  if (design.pairs) {
    if (!design.standard)
      table.fail("kind", "needs a standard to compare with", "write standard in [design], or remove pairs");
    if (!(*design.standard)[out.factor])
      table.fail("factor",
                 "= " + base::toml_quoted(design.factors[out.factor].name) +
                     " has no level in standard, so the standard would change with the level",
                 "name a level of this factor in standard");
    out.comparison = table.choice("positive", {"comparison", "standard"}) == "comparison";
  } else {
    out.positive = static_cast<int>(table.integer("positive", {0, 100}));
  }
}

void read_staircase(const base::TomlTable& table, const Design& design, Procedure& out) {
  const auto& levels = design.factors[out.factor].levels;
  const std::string start = text_of(table, "start");
  const auto found = std::find(levels.begin(), levels.end(), start);
  if (found == levels.end())
    table.fail("start", "= " + base::toml_quoted(start) + " is no level of the factor",
               base::use_one_of(start, levels));
  stats::StaircaseRules& rules = out.rules;
  rules.start = static_cast<double>(found - levels.begin());
  rules.highest = static_cast<double>(levels.size() - 1);
  rules.down_after = static_cast<int>(table.integer_or("down_after", 1, {1, 10}));
  rules.up_after = static_cast<int>(table.integer_or("up_after", 1, {1, 10}));
  rules.up_ratio = table.number_or("up_ratio", 1, {0.1, 10});
  if (table.has("steps")) rules.steps = table.numbers("steps", 0, {1, 100});
  if (rules.steps.empty()) table.fail("steps", "is empty", "write at least one step, in levels");
  rules.fast_start = table.boolean_or("fast_start", false);
  rules.trials = out.trials;
  for (std::size_t i = 0; i < rules.steps.size(); ++i) {
    const double up = rules.steps[i] * rules.up_ratio;
    if (rules.steps[i] != std::round(rules.steps[i]) || std::abs(up - std::round(up)) > 1e-9)
      table.fail_at("steps", i,
                    "= " + shown(rules.steps[i]) + " makes a step that is no whole number of levels",
                    "use whole numbers, also after multiplication by up_ratio");
  }
}

void read_guards(const base::TomlTable& table, std::size_t levels, Procedure& out) {
  // Without trials between the ends, the direct estimate of the PTPE has no fit.
  const int usual = out.kind == ProcedureKind::Ptpe ? stats::usual_between(out.trials) : 0;
  out.fixed = static_cast<int>(table.integer_or("fixed", usual, {0, 500}));
  if (out.fixed > out.trials)
    table.fail("fixed", "= " + std::to_string(out.fixed) + " exceeds trials = " + std::to_string(out.trials),
               "use at most " + std::to_string(out.trials));
  out.most_of_one = out.trials;
  if (table.has("most_of_one")) out.most_of_one = static_cast<int>(table.integer("most_of_one", {1, 500}));
  if (static_cast<std::size_t>(out.most_of_one) * levels < static_cast<std::size_t>(out.trials))
    table.fail("most_of_one",
               "= " + std::to_string(out.most_of_one) + " for each of " + std::to_string(levels) +
                   " levels allows fewer than " + std::to_string(out.trials) + " trials",
               "raise it, or lower trials");
}

void read_quest(const base::TomlTable& table, Procedure& out) {
  const std::string form = table.choice_or("form", "weibull", {"normal", "logistic", "weibull"});
  out.form = *stats::psychometric_form(form);
  if (out.form == stats::PsychometricForm::Weibull && out.values.front() <= 0)
    table.fail("form",
               "= \"weibull\" needs values above 0, and the lowest level has " + shown(out.values.front()),
               "use form = \"normal\", or remove that level");
  out.guess = table.number_or("guess", 0, {0, 0.9});
  if (table.has("lapse")) out.lapses = table.numbers("lapse", 0, {0, 0.2});
  if (out.lapses.empty()) table.fail("lapse", "is empty", "write at least one lapse rate, such as 0.02");
}

/// Reads mean and standard deviation of the frame rate of each level into `out`, for the procedure "ptpe",
/// which chooses among these settings.
void read_moments_of_levels(const base::TomlTable& table, const Design& design, Procedure& out) {
  for (int level = 0; level < static_cast<int>(design.factors[out.factor].levels.size()); ++level) {
    const TimingProfile& profile = profile_of(table, design, out.factor, level);
    if (profile.kind != ProfileKind::Moments)
      table.fail("factor",
                 "has a level without mean and standard deviation: " +
                     design.factors[out.factor].levels[static_cast<std::size_t>(level)],
                 "use profile = \"moments\" in each level");
    out.values.push_back(profile.mean_fps);
    out.deviation.push_back(profile.sd_fps);
  }
}

}  // namespace

const char* procedure_word(ProcedureKind kind) { return procedure_words[static_cast<std::size_t>(kind)]; }

const std::vector<std::string>& axis_keys() {
  static const std::vector<std::string> keys{"hitch_ms", "base_fps", "period_s",   "low_fps",
                                             "mean_fps", "sd_fps",   "latency_ms", "animation_error_ms"};
  return keys;
}

std::optional<double> axis_value(const TimingProfile& profile, const std::string& key) {
  const bool hitches = profile.kind == ProfileKind::Hitches;
  if (key == "hitch_ms" && hitches) return profile.hitch_ms;
  if (key == "base_fps" && hitches) return profile.mean_fps;
  if (key == "period_s" && hitches) return profile.period_s;
  if (key == "low_fps" && profile.kind == ProfileKind::Floor) return profile.low_fps;
  if (key == "mean_fps" && !hitches && profile.kind != ProfileKind::Trace) return profile.mean_fps;
  if (key == "sd_fps" && profile.kind == ProfileKind::Moments) return profile.sd_fps;
  if (key == "latency_ms") return profile.latency_ms;
  if (key == "animation_error_ms") return profile.animation_error_ms;
  return {};
}

Procedure read_procedure(const base::TomlTable& table, const Design& design) {
  Procedure out;
  const std::string kind = table.choice("kind", {"staircase", "quest_plus", "ptpe"});
  out.kind = kind == "staircase"    ? ProcedureKind::Staircase
             : kind == "quest_plus" ? ProcedureKind::QuestPlus
                                    : ProcedureKind::Ptpe;
  if (design.repetitions > 1)
    table.fail("kind",
               "= \"" + kind + "\" chooses the trials itself, so design.repetitions = " +
                   std::to_string(design.repetitions) + " cannot repeat cells",
               "remove repetitions");
  if (design.order != TrialOrder::Shuffle)
    table.fail("kind", "= \"" + kind + "\" interleaves its tracks at random, so it needs order = \"shuffle\"",
               "write order = \"shuffle\" in [design]");
  out.factor = read_factor_index(table, design);
  out.question = id_of(table, "question");
  out.trials = static_cast<int>(table.integer("trials", track_range));
  if (out.kind == ProcedureKind::Ptpe) {
    if (design.pairs) table.fail("kind", "= \"ptpe\" rates single stimuli", "remove pairs");
    read_moments_of_levels(table, design, out);
  } else {
    read_values(table, design, out);
    read_positive(table, design, out);
  }
  if (out.kind == ProcedureKind::Staircase) {
    read_staircase(table, design, out);
  } else {
    read_guards(table, out.values.size(), out);
    if (out.kind == ProcedureKind::QuestPlus) read_quest(table, out);
  }
  return out;
}

void check_procedure_question(const base::TomlTable& table, const Design& design,
                              const std::vector<Block>& blocks) {
  const Procedure& procedure = *design.procedure;
  for (const Block& block : blocks) {
    if (block.kind == BlockKind::Repeat)
      table.fail("kind", "cannot have trials repeated by block " + base::toml_quoted(block.id),
                 "remove that block of kind repeat");
    if (block.kind != BlockKind::Stimulus) continue;
    const auto found = std::find_if(block.questions.begin(), block.questions.end(),
                                    [&](const Question& one) { return one.id == procedure.question; });
    const bool asked = std::any_of(block.steps.begin(), block.steps.end(), [&](const TrialStep& step) {
      return std::count(step.asks.begin(), step.asks.end(), procedure.question) > 0;
    });
    if (found == block.questions.end() || !asked)
      table.fail("question", "= " + base::toml_quoted(procedure.question) + " is not asked in the trials",
                 "ask it in the steps of block " + base::toml_quoted(block.id));
    const auto fits = procedure.kind == ProcedureKind::Ptpe
                          ? [](const AnswerKindTraits& one) { return one.rated(); }
                          : [](const AnswerKindTraits& one) { return one.labelled; };
    if (!fits(traits_of(found->kind)))
      table.fail("question", "= " + base::toml_quoted(procedure.question) + " has answers of another kind",
                 "name a question of kind " + kind_words(fits, " or "));
    const auto scores = scores_of(*found);
    if (procedure.kind == ProcedureKind::Ptpe) continue;
    if (scores.size() != 2)
      table.fail(
          "question",
          "= " + base::toml_quoted(procedure.question) + " has " + std::to_string(scores.size()) + " answers",
          "give it two answers");
    if (procedure.positive && !can_be_given(*found, *procedure.positive))
      table.fail("positive", "= " + std::to_string(*procedure.positive) + " is no answer of that question",
                 "use " + std::to_string(scores.front()) + " or " + std::to_string(scores.back()));
  }
}

}  // namespace study
