#include <algorithm>
#include <map>
#include <set>

#include "libstudy/protocol/readers.hpp"
#include "stats/base/nearest.hpp"

namespace study {

namespace {

using Tables = std::vector<base::TomlTable>;

/// True for SSQ and FMS. Their questions have the same ids in every block, and no other question may have
/// these ids.
bool is_scale_of_its_own(BlockKind kind) { return kind == BlockKind::Ssq || kind == BlockKind::Fms; }

void check_ids(const Tables& tables, const std::vector<Block>& blocks) {
  std::set<std::string> block_ids, question_ids;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!block_ids.insert(blocks[i].id).second)
      tables[i].fail("id", "= \"" + blocks[i].id + "\" is the id of another block", "use another id");
    if (is_scale_of_its_own(blocks[i].kind)) continue;
    for (std::size_t q = 0; q < blocks[i].questions.size(); ++q) {
      const std::string& id = blocks[i].questions[q].id;
      if (!question_ids.insert(id).second)
        tables[i].fail_at("question", q, "has the id \"" + id + "\" of another question", "use another id");
    }
  }
}

/// A trial may ask for "fms" without naming a block, so all fms blocks must agree.
void check_fms(const Tables& tables, const std::vector<Block>& blocks) {
  const Block* first = nullptr;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (blocks[i].kind != BlockKind::Fms) continue;
    if (!first) first = &blocks[i];
    if (blocks[i].questions != first->questions) {
      tables[i].fail("stop_at", "differs from that of block \"" + first->id + "\"",
                     "write the same stop_at in every block of kind fms");
    }
  }
}

/// Checks that all questions with `accept` come before the first block with trials.
void check_accepts(const Tables& tables, const std::vector<Block>& blocks) {
  bool shown = false;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    shown = shown || has_trials(blocks[i].kind);
    for (std::size_t q = 0; shown && q < blocks[i].questions.size(); ++q) {
      if (!blocks[i].questions[q].accept) continue;
      tables[i].fail_at("question", q, "has accept, but its block comes after the first trials",
                        "move the block before all trials, or remove accept");
    }
  }
}

struct Asked {
  const Block* block;
  const Question* question;
};

/// Questions by id. Several blocks may have the questions of ssq or fms; the map has those of the first.
std::map<std::string, Asked> questions_by_id(const std::vector<Block>& blocks) {
  std::map<std::string, Asked> out;
  for (const Block& block : blocks) {
    for (const Question& question : block.questions) out.emplace(question.id, Asked{&block, &question});
  }
  return out;
}

void check_ask(const base::TomlTable& table, std::size_t step, const std::string& id,
               const std::map<std::string, Asked>& questions) {
  const auto found = questions.find(id);
  if (found == questions.end()) {
    std::vector<std::string> known;
    for (const auto& [one, asked] : questions) known.push_back(one);
    const std::string meant = base::nearest_word(id, known);
    table.fail_at("steps", step, "asks \"" + id + "\", which is not the id of any question",
                  (meant.empty() ? "" : "ask \"" + meant + "\" if you mean it, or ") +
                      std::string("add [[block.question]] with this id, or a block of kind fms for \"fms\""));
  }
  const BlockKind kind = found->second.block->kind;
  if (kind != BlockKind::Stimulus && kind != BlockKind::Question && !is_scale_of_its_own(kind)) {
    table.fail_at("steps", step, "asks \"" + id + "\" of a block of kind " + block_kind_name(kind),
                  "ask questions of blocks of kind stimulus, question, ssq or fms");
  }
  if (found->second.question->personal) {
    table.fail_at("steps", step, "asks \"" + id + "\", which is personal",
                  "ask it only on a page, or remove personal");
  }
}

bool asks_reaction(const Question& question) { return traits_of(question.kind).timed; }
constexpr const char* alone_mend = "ask it on a page of its own";

/// Checks that no question of kind reaction shares the page of a block.
void check_reactions(const Tables& tables, const std::vector<Block>& blocks) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const auto& questions = blocks[i].questions;
    if (blocks[i].kind == BlockKind::Stimulus || questions.size() < 2) continue;
    for (std::size_t q = 0; q < questions.size(); ++q)
      if (asks_reaction(questions[q]))
        tables[i].fail_at("question", q, "is a reaction and shares its page", alone_mend);
  }
}

/// Checks that the trials ask every question of the block, and no question of any block twice.
void check_asks(const base::TomlTable& table, const Block& block,
                const std::map<std::string, Asked>& questions) {
  std::set<std::string> asked;
  for (std::size_t step = 0; step < block.steps.size(); ++step) {
    for (const auto& id : block.steps[step].asks) {
      check_ask(table, step, id, questions);
      if (block.steps[step].asks.size() > 1 && asks_reaction(*questions.at(id).question))
        table.fail_at("steps", step, "asks \"" + id + "\", a reaction, together with others", alone_mend);
      if (!asked.insert(id).second)
        table.fail_at("steps", step, "asks \"" + id + "\" for the second time", "ask it once in a trial");
    }
  }
  for (std::size_t q = 0; q < block.questions.size(); ++q) {
    if (!asked.count(block.questions[q].id)) {
      table.fail_at("question", q, "\"" + block.questions[q].id + "\" is asked by no step",
                    "add its id to an \"ask\" of steps, or remove it");
    }
  }
}

void check_count(const base::TomlTable& table, const Block& block, const Design& design) {
  const int trials = design.groups * trials_of_group(design);
  if (block.kind == BlockKind::Practice || block.count <= trials) return;
  table.fail("count", "= " + std::to_string(block.count) + " is more than the number of trials",
             "use at most " + std::to_string(trials));
}

/// Id of the only block of kind stimulus.
std::string stimulus_block(const std::vector<Block>& blocks) {
  return std::find_if(blocks.begin(), blocks.end(),
                      [](const Block& block) { return block.kind == BlockKind::Stimulus; })
      ->id;
}

/// For a Practice, Repeat or Catch block: checks that `like` names the stimulus block. Practice and Repeat
/// copy its steps and its interruption policy.
void join_like(const base::TomlTable& table, const Design& design, std::vector<Block>& blocks,
               std::size_t index) {
  Block& block = blocks[index];
  const auto model = std::find_if(blocks.begin(), blocks.end(), [&](const Block& other) {
    return other.id == block.like && other.kind == BlockKind::Stimulus;
  });
  if (model == blocks.end())
    table.fail("like", "= \"" + block.like + "\" is no block of kind stimulus",
               "write the id of that block, \"" + stimulus_block(blocks) + "\"");
  const auto place = static_cast<std::size_t>(model - blocks.begin());
  if (block.kind == BlockKind::Repeat && place > index)
    table.fail("like", "names a later block", "put the repeats after what they repeat");
  if (block.kind == BlockKind::Practice && place < index)
    table.fail("like", "names an earlier block", "put practice before what it prepares for");
  if (has_trials(block.kind)) {
    block.steps = model->steps;
    block.on_interruption = model->on_interruption;
  }
  check_count(table, block, design);
}

}  // namespace

void join_blocks(const Tables& tables, const Design& design, std::vector<Block>& blocks) {
  check_ids(tables, blocks);
  check_fms(tables, blocks);
  check_accepts(tables, blocks);
  check_reactions(tables, blocks);
  const auto questions = questions_by_id(blocks);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (blocks[i].kind == BlockKind::Stimulus) check_asks(tables[i], blocks[i], questions);
    if (!blocks[i].like.empty()) join_like(tables[i], design, blocks, i);
  }
}

}  // namespace study
