#include "stats/base/nearest.hpp"

#include <algorithm>

namespace base {

namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

constexpr std::size_t longest_compared = 100;  // bytes; the work is quadratic in the length

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  // `before`, `last` and `row` are rows i - 2, i - 1 and i of the table of distances. Column j holds the
  // distance between the first i letters of a and the first j letters of b.
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0u : 1u)});
      const bool swapped =
          i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

std::string nearest_word(std::string_view word, const std::vector<std::string>& known) {
  std::string nearest;
  if (word.empty() || word.size() > longest_compared) return nearest;
  std::size_t least = word.size() / 3 + 1;  // from this distance on the word counts as a different one
  for (const auto& one : known) {
    if (one.size() > longest_compared) continue;
    const std::size_t distance = edit_distance(word, one);
    if (distance >= least) continue;
    least = distance;
    nearest = one;
  }
  return nearest;
}

std::string use_one_of(std::string_view word, const std::vector<std::string>& known) {
  std::string out;
  for (const auto& one : known) out += (out.empty() ? "use one of \"" : ", \"") + one + "\"";
  const std::string nearest = nearest_word(word, known);
  return nearest.empty() ? out : out + "; the nearest is \"" + nearest + "\"";
}

}  // namespace base
