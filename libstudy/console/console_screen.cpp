#include "libstudy/console/console_screen.hpp"

#include <algorithm>
#include <cmath>

#include "stats/base/text.hpp"

namespace study {

namespace {

constexpr int bar_columns = 20;
constexpr std::size_t most_alarms = 3, fixed_rows = 19;

/// Terminal columns of one UTF-8 character: 2 for wide ones (East Asian, emoji), else 1.
int columns_of(std::string_view character) {
  if (character.size() < 3) return 1;
  char32_t code = static_cast<unsigned char>(character[0]) & (character.size() == 3 ? 0x0Fu : 0x07u);
  for (const char c : character.substr(1)) code = code << 6 | (static_cast<unsigned char>(c) & 0x3Fu);
  constexpr char32_t wide[][2] = {{0x1100, 0x115F}, {0x2E80, 0xA4CF}, {0xAC00, 0xD7A3},   {0xF900, 0xFAFF},
                                  {0xFE30, 0xFE6F}, {0xFF00, 0xFF60}, {0x1F300, 0x1FAFF}, {0x20000, 0x3FFFD}};
  return std::any_of(std::begin(wide), std::end(wide),
                     [&](const auto& range) { return code >= range[0] && code <= range[1]; })
             ? 2
             : 1;
}

int width_of(std::string_view text) {
  int width = 0;
  while (!text.empty()) {
    const std::size_t bytes = std::max<std::size_t>(1, base::utf8_length(text));
    width += columns_of(text.substr(0, bytes));
    text.remove_prefix(bytes);
  }
  return width;
}

/// The longest beginning of the text that fits into the columns; ends in "..." if text was cut off.
std::string fitted(const std::string& text, int columns) {
  if (width_of(text) <= columns) return text;
  const int room = std::max(0, columns - 3);
  std::string out;
  int width = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t bytes = std::max<std::size_t>(1, base::utf8_length(rest));
    width += columns_of(rest.substr(0, bytes));
    if (width > room) break;
    out += rest.substr(0, bytes);
    rest.remove_prefix(bytes);
  }
  return (out + "...").substr(0, columns < 3 ? static_cast<std::size_t>(columns) : std::string::npos);
}

/// The longest end of the text that fits into the columns: the last typed characters stay visible.
std::string end_fitted(const std::string& text, int columns) {
  std::string_view rest = text;
  while (width_of(rest) > columns) rest.remove_prefix(std::max<std::size_t>(1, base::utf8_length(rest)));
  return std::string(rest);
}

std::string bar(double share) {
  const int full = static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * bar_columns));
  return "[" + std::string(static_cast<std::size_t>(full), '#') +
         std::string(static_cast<std::size_t>(bar_columns - full), '.') + "] ";
}

std::string labelled(const char* label, const std::string& text) {
  std::string out = label;
  out.resize(9, ' ');
  return out + text;
}

std::string head(const ConsoleView& view, int columns) {
  const std::string title = fitted(view.title, columns - static_cast<int>(view.clock.size()) - 1);
  const int gap = columns - width_of(title) - static_cast<int>(view.clock.size());
  return title + std::string(static_cast<std::size_t>(std::max(1, gap)), ' ') + view.clock;
}

void add_alarms(const std::vector<std::string>& alarms, std::vector<std::string>& lines) {
  for (std::size_t i = 0; i < most_alarms; ++i) {
    const bool more = i + 1 == most_alarms && alarms.size() > most_alarms;
    const std::string text = more                ? std::to_string(alarms.size() - i) + " more: " + alarms[i]
                             : i < alarms.size() ? alarms[i]
                             : i == 0            ? "none"
                                                 : "";
    lines.push_back(labelled(i == 0 ? (alarms.empty() ? "Alarms" : "ALARMS") : "", text));
  }
}

}  // namespace

std::vector<std::string> render_console(const ConsoleView& view, int columns, int rows) {
  const std::string rule(static_cast<std::size_t>(columns), '-');
  std::vector<std::string> lines{
      head(view, columns),
      rule,
      labelled("Plan", bar(view.done) + view.plan),
      labelled("Now", view.now),
      labelled("Person", view.person),
      labelled("Station", view.station),
      rule,
      labelled("Timing", view.rate),
      labelled("Strip", view.strip),
      labelled("", "a sign each half second:  . on time  + faster  - slower  ! by over 20 %"),
      labelled("Last", view.last),
      rule};
  add_alarms(view.alarms, lines);
  lines.push_back(rule);
  const auto height = static_cast<std::size_t>(rows);
  const std::size_t room = height > fixed_rows ? height - fixed_rows : 0,
                    said = std::min(room, view.said.size());
  lines.insert(lines.end(), view.said.end() - static_cast<std::ptrdiff_t>(said), view.said.end());
  lines.resize(lines.size() + room - said);
  lines.emplace_back("p pause, go on   r repeat the trial   x exclude the trial   n note");
  lines.emplace_back("e end the session   m method and setting (logged)   ? what keys do");
  for (std::string& line : lines) line = fitted(line, columns);
  lines.push_back(end_fitted("> " + view.typed, columns));
  // If the terminal has too few rows, keeps the top rows and the typed line.
  if (lines.size() > height) lines.erase(lines.begin() + rows - 1, lines.end() - 1);
  return lines;
}

}  // namespace study
