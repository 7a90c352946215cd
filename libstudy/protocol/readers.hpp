#pragma once
/// Parts of a protocol file, each read by one translation unit. Errors as parse_protocol().

#include <string>
#include <string_view>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "stats/base/toml.hpp"

namespace study {

inline constexpr base::Range fps_range{0.1, 1000};
inline constexpr base::Range duration_range{0.1, 3600};
inline constexpr base::Range pause_range{0, 3600};

/// A text that holds more than white space.
std::string text_of(const base::TomlTable& table, std::string_view key);
/// A name that steps and tables of data can hold: a letter, then letters, digits and '_', 64 at most.
std::string id_of(const base::TomlTable& table, std::string_view key);
/// Whether it is such a name.
bool is_id(std::string_view word);
/// A number as messages show it.
std::string shown(double value);

/// Everything but the text itself; `root` is not finished, so that it can still tell what was asked of it.
Protocol read_protocol_table(const base::TomlTable& root, ProtocolUse use = ProtocolUse::New);

Design read_design(const base::TomlTable& table);
/// Levels of the factor effects; none where the design does not vary them.
std::vector<EffectSet> read_effect_sets(const base::TomlTable& design);
/// Every combination of the factors, by scene, n_*, method, effects and moments.
std::vector<Cell> read_cells(const base::TomlTable& design, TimingSource timing,
                             const std::vector<EffectSet>& effects);
/// A list of words, none empty or twice.
std::vector<std::string> distinct_words(const base::TomlTable& table, std::string_view key);
HeadsetRules read_headset(const base::TomlTable& table);
PacingRules read_pacing(const base::TomlTable& table, const Design& design);
std::vector<Block> read_blocks(const base::TomlTable& root, const Design& design, const std::string& language,
                               ProtocolUse use);
/// What each trial of a block does.
std::vector<TrialStep> read_steps(const base::TomlTable& block, bool pairs);
/// The questions that the program obeys are asked so that it can. tables: those that the blocks were read
/// from.
void check_obeyed_questions(const std::vector<base::TomlTable>& tables, const std::vector<Block>& blocks);
/// Methods are those of method_names(), and n_star holds numbers of particles.
void check_design_names(const base::TomlTable& design);
/// No id is a misspelling of one of known_question_ids() that the protocol lacks.
void check_question_ids(const std::vector<base::TomlTable>& tables, const std::vector<Block>& blocks);
/// The questions of a block of this kind.
std::vector<Question> read_questions(const base::TomlTable& block, BlockKind kind,
                                     const std::string& language);
/// What only all blocks together tell: ids, and what `like` and `ask` name. Fills in the steps that blocks
/// take over. tables: those that the blocks were read from.
void join_blocks(const std::vector<base::TomlTable>& tables, const Design& design,
                 std::vector<Block>& blocks);

}  // namespace study
