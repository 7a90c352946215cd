#include "stats/figures/text_table.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <sstream>

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

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> out;
  std::istringstream stream(line);
  for (std::string part; std::getline(stream, part, separator);) out.push_back(part);
  return out;
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
