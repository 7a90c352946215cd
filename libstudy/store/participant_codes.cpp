#include "libstudy/store/participant_codes.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "stats/base/error.hpp"

namespace study {

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string folded(const std::string& code) {
  std::string letters;
  for (const char c : code)
    if (std::isalnum(static_cast<unsigned char>(c)))
      letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return letters;
}

/// The text with leading zeros removed from each number in it.
std::string without_zeros(const std::string& code) {
  std::string out;
  for (std::size_t i = 0; i < code.size(); ++i) {
    const bool begins =
        code[i] == '0' && (i == 0 || !is_digit(code[i - 1]) || out.empty() || !is_digit(out.back()));
    if (begins && i + 1 < code.size() && is_digit(code[i + 1])) continue;
    out += code[i];
  }
  return out;
}

}  // namespace

bool reads_as_missing(const std::string& code) {
  constexpr std::array words{"na", "nan", "null", "none", "nil", "missing", "undefined"};
  return std::find(words.begin(), words.end(), folded(code)) != words.end();
}

bool are_alike(const std::string& one, const std::string& other) {
  return folded(one) == folded(other) || folded(without_zeros(one)) == folded(without_zeros(other));
}

void check_new_code(sqlite::Connection& database, const std::string& code) {
  sqlite::Statement known(database, "SELECT 1 FROM session WHERE participant = ?");
  if (known.bind_all(code).step()) return;
  const std::string place = database.path().string();
  if (reads_as_missing(code)) {
    throw base::Error(place, "participant " + code + " reads as a missing value in other programs",
                      "give another code, such as P01");
  }
  sqlite::Statement row(database,
                        "SELECT participant FROM session UNION SELECT participant FROM tombstone ORDER BY 1");
  while (row.step()) {
    const std::string other = row.text(0);
    if (other == code || !are_alike(other, code)) continue;
    throw base::Error(
        place,
        "participant " + code + " differs from " + other +
            " only in case, punctuation or leading zeros, and people and other programs confuse them",
        "write " + other + " if it is the same person, or give another code");
  }
}

}  // namespace study
