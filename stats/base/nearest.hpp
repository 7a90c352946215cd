#pragma once
/// A word that is none of those known: which of them was meant.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace base {

/// Fewest letters inserted, removed, replaced, or swapped with their neighbour that make `b` of `a`; the case
/// of ASCII letters does not count.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The known word that lies nearest to `word`; empty when more than a third of its letters differ.
std::string nearest_word(std::string_view word, const std::vector<std::string>& known);

/// What to do about a word that is none of the known ones: `use one of "a", "b"`, and behind it the nearest
/// one, when one is near.
std::string use_one_of(std::string_view word, const std::vector<std::string>& known);

}  // namespace base
