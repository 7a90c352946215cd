#include <algorithm>
#include <array>
#include <sstream>

#include "libstudy/protocol/readers.hpp"

namespace study {

namespace {

/// Reads one step of a trial from the list `steps`, such as "black 3", "stimulus first" or "ask realism".
class StepReader {
 public:
  StepReader(const base::TomlTable& table, std::size_t index, const std::string& text, bool pairs)
      : table_(table), index_(index), text_(text), words_(text), pairs_(pairs) {}

  TrialStep read() {
    std::string word;
    words_ >> word;
    TrialStep out;
    if (word == "black" || word == "rest") {
      out.kind = word == "black" ? StepKind::Black : StepKind::Rest;
      out.seconds = seconds();
    } else if (word == "stimulus") {
      out.interval = interval();
    } else if (word == "ask") {
      out.kind = StepKind::Ask;
      out.asks = ids();
    } else {
      fail("is no step", "write \"black SECONDS\", \"rest SECONDS\", \"stimulus\" or \"ask ID ID ...\"");
    }
    if (words_ >> word) fail("has the extra word '" + word + "'", "remove it, or make it a step of its own");
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& problem, const std::string& mend) const {
    table_.fail_at("steps", index_, "= " + base::toml_quoted(text_) + " " + problem, mend);
  }

  double seconds() {
    double out = -1;
    if (!(words_ >> out) || !(out >= pause_range.min && out <= pause_range.max))
      fail("lacks seconds from 0 to 3600", "write \"black 3\" or \"rest 30\"");
    return out;
  }

  int interval() {
    std::string which;
    if (!pairs_) return 0;  // read() refuses any further word
    words_ >> which;
    if (which != "first" && which != "second") {
      fail("does not say which stimulus of the pair",
           "write \"stimulus first\" and \"stimulus second\", as the design shows pairs");
    }
    return which == "second" ? 1 : 0;
  }

  std::vector<std::string> ids() {
    std::vector<std::string> out;
    for (std::string id; words_ >> id;) out.push_back(id);
    words_.clear();
    if (out.empty()) fail("asks no question", "write \"ask ID\"");
    return out;
  }

  const base::TomlTable& table_;
  std::size_t index_;
  const std::string& text_;
  std::istringstream words_;
  bool pairs_;
};

/// Checks that the steps show all stimuli, first before second, and then ask a question.
void check_steps(const base::TomlTable& table, const std::vector<TrialStep>& steps, bool pairs) {
  int seen = 0;
  bool asked = false;
  const int wanted = pairs ? 2 : 1;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    asked = asked || steps[i].kind == StepKind::Ask;
    if (steps[i].kind != StepKind::Stimulus) continue;
    if (asked) table.fail_at("steps", i, "comes after a question", "ask after all stimuli");
    if (seen == wanted || steps[i].interval != seen) {
      table.fail_at("steps", i, "shows a stimulus out of order",
                    pairs ? "show first, then second, each once" : "show the stimulus once");
    }
    ++seen;
  }
  if (seen != wanted)
    table.fail("steps", "show too few stimuli",
               pairs ? "add \"stimulus first\" and \"stimulus second\"" : "add \"stimulus\"");
  if (!asked) table.fail("steps", "ask no question", "add \"ask ID\"");
}

std::vector<TrialStep> read_steps(const base::TomlTable& block, bool pairs) {
  const auto texts = block.strings("steps");
  std::vector<TrialStep> out;
  for (std::size_t i = 0; i < texts.size(); ++i) out.push_back(StepReader(block, i, texts[i], pairs).read());
  check_steps(block, out, pairs);
  return out;
}

struct KindName {
  BlockKind kind;
  const char* name;
};

constexpr std::array<KindName, 16> kind_names{{{BlockKind::Instructions, "instructions"},
                                               {BlockKind::Screening, "screening"},
                                               {BlockKind::Consent, "consent"},
                                               {BlockKind::Demographics, "demographics"},
                                               {BlockKind::Practice, "practice"},
                                               {BlockKind::Stimulus, "stimulus"},
                                               {BlockKind::Question, "question"},
                                               {BlockKind::Rest, "rest"},
                                               {BlockKind::Break, "break"},
                                               {BlockKind::Black, "black"},
                                               {BlockKind::Repeat, "repeat"},
                                               {BlockKind::Catch, "catch"},
                                               {BlockKind::Ssq, "ssq"},
                                               {BlockKind::GazeValidation, "gaze_validation"},
                                               {BlockKind::Fms, "fms"},
                                               {BlockKind::Debrief, "debrief"}}};

constexpr std::size_t most_blocks = 200;

BlockKind read_block_kind(const base::TomlTable& table) {
  std::vector<std::string> words;
  for (const auto& known : kind_names) words.emplace_back(known.name);
  const std::string word = table.choice("kind", words);
  return std::find_if(kind_names.begin(), kind_names.end(), [&](const auto& k) { return word == k.name; })
      ->kind;
}

bool any_of(BlockKind kind, std::initializer_list<BlockKind> kinds) {
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

/// Reads title, text and duration of a block.
void read_page(const base::TomlTable& table, Block& block) {
  if (block.kind == BlockKind::GazeValidation) return;
  if (block.kind != BlockKind::Black) block.title = table.string_or("title", "");
  if (any_of(block.kind, {BlockKind::Instructions, BlockKind::Consent, BlockKind::Debrief}))
    block.text = text_of(table, "text");
  else if (block.kind != BlockKind::Black && !has_trials(block.kind))
    block.text = table.string_or("text", "");
  if (any_of(block.kind, {BlockKind::Rest, BlockKind::Break, BlockKind::Black}))
    block.seconds = table.number("seconds", pause_range);
  if (any_of(block.kind, {BlockKind::Instructions, BlockKind::Debrief}))
    block.seconds = table.number_or("seconds", 0, pause_range);
}

void read_block_questions(const base::TomlTable& table, Block& block, const std::string& language) {
  if (any_of(block.kind, {BlockKind::Ssq, BlockKind::Fms}) && !language.starts_with("en")) {
    table.fail("kind",
               "= \"" + block_kind_name(block.kind) +
                   "\" is available in English only, and the language is \"" + language + "\"",
               "write the items in your language as [[block.question]] of a block of kind question");
  }
  if (block.kind == BlockKind::Ssq) block.questions = ssq_questions(language);
  if (block.kind == BlockKind::Fms) {
    std::optional<int> stop_at;
    if (table.has("stop_at")) stop_at = static_cast<int>(table.integer("stop_at", {1, 20}));
    block.questions = {fms_question(language, stop_at)};
  }
  if (!any_of(block.kind, {BlockKind::Screening, BlockKind::Consent, BlockKind::Demographics,
                           BlockKind::Stimulus, BlockKind::Question, BlockKind::Catch}))
    return;
  block.questions = read_questions(table, block.kind, language);
  if (block.questions.empty())
    table.fail("", "has no question", "add [[block.question]], or use kind = \"instructions\"");
  const bool decides = std::any_of(block.questions.begin(), block.questions.end(),
                                   [](const Question& question) { return question.accept.has_value(); });
  if (block.kind == BlockKind::Consent && !decides) {
    table.fail("question", "lets everybody continue: no answer counts as a refusal",
               "add accept = [1, 1] to the question that gives consent");
  }
}

Interruption read_interruption(const base::TomlTable& table) {
  const std::string word =
      table.choice_or("on_interruption", "resume", {"resume", "restart_block", "invalidate"});
  if (word == "restart_block") return Interruption::RestartBlock;
  return word == "invalidate" ? Interruption::Invalidate : Interruption::Resume;
}

/// Reads break_every and break_s: the breaks between the trials of a design of format 3.
void read_breaks(const base::TomlTable& table, const Design& design, Block& block) {
  if (!table.has("break_every")) {
    if (table.has("break_s"))
      table.fail("break_s", "has no effect without break_every", "add break_every, or remove break_s");
    return;
  }
  block.break_every = static_cast<int>(table.integer("break_every", {1, most_trials}));
  block.break_s = table.number("break_s", pause_range);
  const int trials = design.groups * trials_of_group(design);
  if (block.break_every >= trials)
    table.fail("break_every",
               "= " + std::to_string(block.break_every) + " makes no break: a participant has " +
                   std::to_string(trials) + " trials",
               "write a number below " + std::to_string(trials) + ", or remove break_every and break_s");
}

void read_trials(const base::TomlTable& table, const Design& design, Block& block) {
  block.steps = read_steps(table, design.pairs);
  block.between_groups_s = table.number_or("between_groups_s", 0, pause_range);
  if (!design.factors.empty()) read_breaks(table, design, block);
  block.on_interruption = read_interruption(table);
  if (block.between_groups_s > 0 && design.groups == 1) {
    table.fail("between_groups_s", "has no effect: a participant sees only one group",
               "remove it, or raise design.groups (format 2)");
  }
}

void read_validation(const base::TomlTable& table, Block& block) {
  block.count = static_cast<int>(table.integer_or("tries", 3, {1, 20}));
  block.extent_deg = table.number_or("extent_deg", 10, {1, 30});
  if (table.has("max_accuracy_deg")) block.max_accuracy_deg = table.number("max_accuracy_deg", {0.1, 20});
}

Block read_block(const base::TomlTable& table, const Design& design, const std::string& language) {
  Block block;
  block.kind = read_block_kind(table);
  block.id = id_of(table, "id");
  read_page(table, block);
  if (any_of(block.kind, {BlockKind::Practice, BlockKind::Repeat, BlockKind::Catch})) {
    block.count = static_cast<int>(table.integer("count", {1, 1000}));
    block.like = text_of(table, "like");
  }
  read_block_questions(table, block, language);
  if (block.kind == BlockKind::Stimulus) read_trials(table, design, block);
  if (block.kind == BlockKind::GazeValidation) read_validation(table, block);
  return block;
}

}  // namespace

std::string block_kind_name(BlockKind kind) {
  return std::find_if(kind_names.begin(), kind_names.end(), [&](const auto& k) { return kind == k.kind; })
      ->name;
}

bool has_trials(BlockKind kind) {
  return any_of(kind, {BlockKind::Practice, BlockKind::Stimulus, BlockKind::Repeat});
}

std::vector<Block> read_blocks(const base::TomlTable& root, const Design& design, const std::string& language,
                               ProtocolUse use) {
  const auto tables = root.tables("block");
  if (tables.size() > most_blocks) {
    root.fail_at("block", most_blocks, "is one more than the " + std::to_string(most_blocks) + " allowed",
                 "join pages");
  }
  std::vector<Block> blocks;
  for (const auto& table : tables) blocks.push_back(read_block(table, design, language));
  const auto trials = std::count_if(blocks.begin(), blocks.end(),
                                    [](const Block& b) { return b.kind == BlockKind::Stimulus; });
  if (trials != 1) {
    root.fail("block", "has " + std::to_string(trials) + " blocks of kind stimulus",
              "write exactly one, which shows the design");
  }
  if (use == ProtocolUse::New) {
    check_question_ids(tables, blocks);
    check_obeyed_questions(tables, blocks);
  }
  join_blocks(tables, design, blocks);
  return blocks;
}

}  // namespace study
