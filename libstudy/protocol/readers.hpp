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

/// A text that holds more than white space.
std::string text_of(const base::TomlTable& table, std::string_view key);
/// A number as messages show it.
std::string shown(double value);

Design read_design(const base::TomlTable& table);
PacingRules read_pacing(const base::TomlTable& table, const Design& design);
std::vector<Block> read_blocks(const base::TomlTable& root, const Design& design,
                               const std::string& language);
std::vector<Question> read_questions(const base::TomlTable& block, const std::string& language);

}  // namespace study
