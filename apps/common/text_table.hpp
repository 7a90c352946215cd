#pragma once
/// Tables of text as CSV and Markdown.

#include <string>
#include <vector>

namespace apps {

/// For a cell of a table; "-" for NaN, "inf" for either infinity.
std::string number(double value, int digits);

/// With as many digits as tell it from others, at most four: "0.01667", "4".
std::string shortest(double value);

/// Free text as one cell of either kind of table.
std::string in_a_cell(std::string text);

/// Rows of text cells as CSV and as a Markdown table; numbers were formatted by the caller.
struct TextTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};
std::string to_csv(const TextTable& table);
std::string to_markdown(const TextTable& table);

}  // namespace apps
