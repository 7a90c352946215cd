#include "stats/base/outgoing.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace base {

namespace {

constexpr std::size_t longest_name = 200;
constexpr const char* name_letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";

bool is_file_name(const std::string& name) {
  return !name.empty() && name.size() <= longest_name && name.front() != '.' && name.front() != '-' &&
         name.find_first_not_of(name_letters) == std::string::npos;
}

/// Length in bytes of a character that begins with `first`.
std::size_t expected_length(unsigned char first) {
  if (first < 0xC2 || first > 0xF4) return 1;
  return first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
}

}  // namespace

void check_file_name(const std::string& name, const std::string& place) {
  std::istringstream parts(name);
  bool good = !name.empty() && name.back() != '/';
  for (std::string part; std::getline(parts, part, '/');) good = good && is_file_name(part);
  if (good) return;
  throw Error(
      place, "would hold a file '" + shortened(name) + "', which is not an allowed file name",
      "nothing was written; get the database or protocol that names this file again, from a source you "
      "trust");
}

std::string TerminalText::next(std::string_view part) {
  waiting_ += part;
  std::string out;
  std::string_view text = waiting_;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const bool cut = length == 0 && text.size() < expected_length(static_cast<unsigned char>(text[0])) &&
                     std::all_of(text.begin() + 1, text.end(),
                                 [](char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; });
    if (cut) break;
    const std::string_view character = text.substr(0, std::max<std::size_t>(length, 1));
    if (character == "\n" || character == "\t" || (length > 0 && is_plain_line(character)))
      out += character;
    else
      out += '?';
    text.remove_prefix(character.size());
  }
  waiting_ = std::string(text);
  return out;
}

std::string TerminalText::rest() { return std::string(std::exchange(waiting_, {}).empty() ? "" : "?"); }

}  // namespace base
