#include "stats/figures/text_table.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>

namespace figures {

std::string number(double value, int digits) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return "inf";
  return fmt::format("{:.{}f}", value, digits);
}

std::string shortest(double value) { return fmt::format("{:.4g}", value); }

std::string in_a_cell(std::string text) {
  std::replace(text.begin(), text.end(), ',', ';');
  std::replace(text.begin(), text.end(), '|', '/');
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::string to_csv(const TextTable& table) {
  std::string out;
  const auto line = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) out += (i ? "," : "") + cells[i];
    out += "\n";
  };
  line(table.head);
  for (const auto& row : table.rows) line(row);
  return out;
}

std::string to_markdown(const TextTable& table) {
  std::string out;
  const auto line = [&](const std::vector<std::string>& cells) {
    for (const auto& cell : cells) out += "| " + cell + " ";
    out += "|\n";
  };
  line(table.head);
  line(std::vector<std::string>(table.head.size(), "---"));
  for (const auto& row : table.rows) line(row);
  return out;
}

}  // namespace figures
