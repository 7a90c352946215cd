#pragma once
/// Readers of the parts of a protocol file. They throw base::Error at file:line:column for a wrong type, a
/// value out of range or two keys that contradict each other.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "stats/base/toml.hpp"

namespace study {

inline constexpr base::Range fps_range{0.1, 1000};
inline constexpr base::Range duration_range{0.1, 3600};
inline constexpr base::Range pause_range{0, 3600};

/// Reads a text that is not blank.
std::string text_of(const base::TomlTable& table, std::string_view key);
/// Reads an id that is valid in steps and data tables: a letter, then letters, digits and '_', at most 64
/// characters.
std::string id_of(const base::TomlTable& table, std::string_view key);
/// True if `word` has the form of an id; see id_of().
bool is_id(std::string_view word);
/// Text of a number for messages.
std::string shown(double value);

/// Reads all fields of a protocol except place, text and sha256. Does not refuse unknown keys
/// (TomlTable::finish), so that a test can list the keys that the readers look up.
Protocol read_protocol_table(const base::TomlTable& root, ProtocolUse use = ProtocolUse::New);

/// Reads [design] of format 2.
Design read_design(const base::TomlTable& table);
/// Reads [stimulus], [[factor]], [[combination]] and [design] of format 3; `table` is [design], `procedure`
/// is [procedure] or null.
Design read_factor_design(const base::TomlTable& root, const base::TomlTable& table,
                          const base::TomlTable* procedure);
/// Reads order, never_adjacent and assignment into `out`, which must already have its cells, pairs, groups
/// and repetitions.
void read_assignment(const base::TomlTable& design, Design& out);
/// The effects of each level, from [[design.effect_set]]. `no_table` is called with the index of a level that
/// has no table and needs one; it must throw.
std::vector<EffectSet> effect_sets_of(const base::TomlTable& design, const std::vector<std::string>& levels,
                                      const std::function<void(std::size_t)>& no_table);
inline constexpr const char* effect_set_mend =
    "add [[design.effect_set]] with this name, or use none or scene";
/// Reads [procedure]. `design` must already have its cells, pairs, order and repetitions.
Procedure read_procedure(const base::TomlTable& table, const Design& design);
/// Checks that the trials ask the procedure's question, that its answers suit the procedure, and that no
/// block repeats trials.
void check_procedure_question(const base::TomlTable& table, const Design& design,
                              const std::vector<Block>& blocks);
/// Reads a timing profile.
TimingProfile read_profile(const base::TomlTable& table);
/// True if `word` is in method_names().
bool is_method(const std::string& word);
/// True for a positive whole number, optionally with the suffix k or K.
bool is_particle_count(const std::string& word);
inline constexpr int most_trials = 1000;  ///< largest number of trials of one participant
inline constexpr std::size_t most_cells = 1000;
/// Every combination of the factors, ordered by scene, n_*, method, effects and moments (mean and standard
/// deviation of the frame rate).
std::vector<Cell> read_cells(const base::TomlTable& design, TimingSource timing,
                             const std::vector<EffectSet>& effects);
/// Reads a list of words; refuses empty and repeated words.
std::vector<std::string> distinct_words(const base::TomlTable& table, std::string_view key);
std::vector<Block> read_blocks(const base::TomlTable& root, const Design& design, const std::string& language,
                               ProtocolUse use);
/// Checks that gaze_question and sharing_question are asked in a form on which the program can act. tables:
/// the blocks' TOML tables.
void check_obeyed_questions(const std::vector<base::TomlTable>& tables, const std::vector<Block>& blocks);
/// Checks that methods are in method_names() and that the words of n_star are numbers of particles.
void check_design_names(const base::TomlTable& design);
/// Checks that no id is a misspelling of one of known_question_ids() that the protocol lacks.
void check_question_ids(const std::vector<base::TomlTable>& tables, const std::vector<Block>& blocks);
/// Reads the questions of a block of this kind.
std::vector<Question> read_questions(const base::TomlTable& block, BlockKind kind,
                                     const std::string& language);
/// Checks the rules that involve several blocks: unique ids, equal stop_at of all fms blocks, `accept` only
/// before the first trials, reactions alone on their pages, the ids in `like` and `ask`, and `count` not
/// above the number of trials. Copies steps and the policy for interruptions from the block `like` to
/// practice and repeat blocks. tables: the blocks' TOML tables.
void join_blocks(const std::vector<base::TomlTable>& tables, const Design& design,
                 std::vector<Block>& blocks);

}  // namespace study
