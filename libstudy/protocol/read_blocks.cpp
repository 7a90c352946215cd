#include <algorithm>
#include <array>
#include <set>
#include <sstream>

#include "libstudy/protocol/readers.hpp"

namespace study {

namespace {

struct KindName {
  BlockKind kind;
  const char* name;
};

constexpr std::array<KindName, 15> kind_names{{{BlockKind::Instructions, "instructions"},
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
                                               {BlockKind::Fms, "fms"},
                                               {BlockKind::Debrief, "debrief"}}};

constexpr base::Range pause_range{0, 3600};

BlockKind read_kind(const base::TomlTable& table) {
  std::vector<std::string> words;
  for (const auto& known : kind_names) words.emplace_back(known.name);
  const std::string word = table.choice("kind", words);
  return std::find_if(kind_names.begin(), kind_names.end(), [&](const auto& k) { return word == k.name; })
      ->kind;
}

bool any_of(BlockKind kind, std::initializer_list<BlockKind> kinds) {
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

double pause_of(const base::TomlTable& table, const std::string& step, std::istringstream& words) {
  double seconds = -1;
  words >> seconds;
  if (!words || !(seconds >= pause_range.min && seconds <= pause_range.max)) {
    table.fail("steps", "holds '" + step + "' without seconds from 0 to 3600",
               "write \"black 3\" or \"rest 30\"");
  }
  return seconds;
}

/// One step as text; see TrialStep.
TrialStep read_step(const base::TomlTable& table, const std::string& step, bool pairs) {
  std::istringstream words(step);
  std::string word;
  words >> word;
  TrialStep out;
  if (word == "black" || word == "rest") {
    out.kind = word == "black" ? StepKind::Black : StepKind::Rest;
    out.seconds = pause_of(table, step, words);
  } else if (word == "stimulus") {
    std::string which;
    words >> which;
    const bool fits = pairs ? which == "first" || which == "second" : which.empty();
    if (!fits) {
      table.fail("steps", "holds '" + step + "'",
                 pairs ? "write \"stimulus first\" and \"stimulus second\", as the design shows pairs"
                       : "write \"stimulus\", as the design shows no pairs");
    }
    out.interval = which == "second" ? 1 : 0;
  } else if (word == "ask") {
    out.kind = StepKind::Ask;
    for (std::string id; words >> id;) out.asks.push_back(id);
    if (out.asks.empty()) table.fail("steps", "holds 'ask' without a question", "write \"ask ID\"");
  } else {
    table.fail("steps", "holds '" + step + "'", "use black, stimulus, ask or rest");
  }
  std::string rest;
  if (words.clear(), words >> rest) table.fail("steps", "holds '" + step + "' with more than it takes", "");
  return out;
}

void check_steps(const base::TomlTable& table, const std::vector<TrialStep>& steps, bool pairs) {
  int seen = 0;
  bool asked = false;
  for (const auto& step : steps) {
    asked = asked || step.kind == StepKind::Ask;
    if (step.kind != StepKind::Stimulus) continue;
    if (asked || step.interval != seen)
      table.fail("steps", "are out of order", "show first, then second, then ask");
    ++seen;
  }
  if (seen != (pairs ? 2 : 1))
    table.fail("steps", "show too few or too many stimuli", pairs ? "show first and second" : "show one");
  if (!asked) table.fail("steps", "ask nothing", "add \"ask ID\"");
}

Block read_block(const base::TomlTable& table, const Design& design, const std::string& language) {
  Block block;
  block.kind = read_kind(table);
  block.id = text_of(table, "id");
  block.title = table.string_or("title", "");
  if (any_of(block.kind, {BlockKind::Instructions, BlockKind::Consent, BlockKind::Debrief}))
    block.text = text_of(table, "text");
  else if (!has_trials(block.kind))
    block.text = table.string_or("text", "");
  if (any_of(block.kind, {BlockKind::Rest, BlockKind::Break, BlockKind::Black}))
    block.seconds = table.number("seconds", pause_range);
  if (any_of(block.kind, {BlockKind::Instructions, BlockKind::Debrief}))
    block.seconds = table.number_or("seconds", 0, pause_range);
  if (any_of(block.kind, {BlockKind::Practice, BlockKind::Repeat, BlockKind::Catch})) {
    block.count = static_cast<int>(table.integer("count", {1, 1000}));
    block.like = text_of(table, "like");
  }
  if (block.kind == BlockKind::Ssq) block.questions = ssq_questions(language);
  if (block.kind == BlockKind::Fms) {
    std::optional<int> stop_at;
    if (table.has("stop_at")) stop_at = static_cast<int>(table.integer("stop_at", {1, 20}));
    block.questions = {fms_question(language, stop_at)};
  }
  if (any_of(block.kind, {BlockKind::Screening, BlockKind::Consent, BlockKind::Demographics,
                          BlockKind::Stimulus, BlockKind::Question, BlockKind::Catch})) {
    block.questions = read_questions(table, language);
    if (block.questions.empty())
      table.fail("", "asks nothing", "add [[block.question]], or use kind = \"instructions\"");
  }
  if (block.kind == BlockKind::Stimulus) {
    for (const auto& step : table.strings("steps"))
      block.steps.push_back(read_step(table, step, design.pairs));
    check_steps(table, block.steps, design.pairs);
    block.between_groups_s = table.number_or("between_groups_s", 0, pause_range);
  }
  return block;
}

/// What only all blocks together tell: ids, and what `like` and `ask` name.
void join_blocks(const std::vector<base::TomlTable>& tables, std::vector<Block>& blocks) {
  std::set<std::string> block_ids, question_ids;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!block_ids.insert(blocks[i].id).second) tables[i].fail("id", "is another block's", "use another one");
    for (const auto& question : blocks[i].questions) {
      const bool ssq_again = blocks[i].kind == BlockKind::Ssq || blocks[i].kind == BlockKind::Fms;
      if (!question_ids.insert(question.id).second && !ssq_again) {
        tables[i].fail("question", "'" + question.id + "' has the id of another", "use another id");
      }
    }
  }
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    for (const auto& step : blocks[i].steps) {
      for (const auto& id : step.asks) {
        if (!question_ids.count(id)) {
          tables[i].fail("steps", "ask '" + id + "', which is no question",
                         "add [[block.question]] with this id, or a block of kind fms for \"fms\"");
        }
      }
    }
    if (blocks[i].like.empty()) continue;
    const auto model = std::find_if(blocks.begin(), blocks.end(), [&](const Block& other) {
      return other.id == blocks[i].like && other.kind == BlockKind::Stimulus;
    });
    if (model == blocks.end())
      tables[i].fail("like", "names no block of kind stimulus", "write the id of one");
    if (has_trials(blocks[i].kind)) blocks[i].steps = model->steps;
    if (blocks[i].kind == BlockKind::Repeat && model - blocks.begin() > static_cast<std::ptrdiff_t>(i))
      tables[i].fail("like", "names a later block", "put the repeats after what they repeat");
  }
}

}  // namespace

std::string block_kind_name(BlockKind kind) {
  return std::find_if(kind_names.begin(), kind_names.end(), [&](const auto& k) { return kind == k.kind; })
      ->name;
}

bool has_trials(BlockKind kind) {
  return any_of(kind, {BlockKind::Practice, BlockKind::Stimulus, BlockKind::Repeat});
}

std::vector<Block> read_blocks(const base::TomlTable& root, const Design& design,
                               const std::string& language) {
  const auto tables = root.tables("block");
  std::vector<Block> blocks;
  for (const auto& table : tables) blocks.push_back(read_block(table, design, language));
  const auto trials = std::count_if(blocks.begin(), blocks.end(),
                                    [](const Block& b) { return b.kind == BlockKind::Stimulus; });
  if (trials != 1) {
    root.fail("block", "has " + std::to_string(trials) + " blocks of kind stimulus",
              "write exactly one, which shows the design");
  }
  join_blocks(tables, blocks);
  return blocks;
}

}  // namespace study
