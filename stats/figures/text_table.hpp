#pragma once
/// Tables of text as CSV and Markdown.

#include <string>
#include <vector>

namespace figures {

/// A number for a cell of a table; "-" for NaN, "inf" for either infinity.
std::string number(double value, int digits);

/// At most four significant digits, without trailing zeros: "0.01667", "4".
std::string shortest(double value);

/// Free text as one cell of a CSV or Markdown table: ',' becomes ';', '|' becomes '/', and line ends become
/// spaces.
std::string in_a_cell(std::string text);

/// Rows of text cells as CSV and as a Markdown table; the caller formats numbers.
struct TextTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};
std::string to_csv(const TextTable& table);
std::string to_markdown(const TextTable& table);

}  // namespace figures
