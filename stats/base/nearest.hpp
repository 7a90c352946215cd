#pragma once
/// Finds the known word that a misspelt word probably means.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace base {

/// Edit distance: the fewest insertions, deletions, replacements and swaps of neighbouring letters that turn
/// `a` into `b`. The case of ASCII letters does not count.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The known word nearest to `word`; empty if the least edit_distance() exceeds a third of the length of
/// `word`, or `word` is longer than 100 bytes.
std::string nearest_word(std::string_view word, const std::vector<std::string>& known);

/// Advice for an unknown word: `use one of "a", "b"`, followed by the word of nearest_word() if there is one.
std::string use_one_of(std::string_view word, const std::vector<std::string>& known);

}  // namespace base
