#pragma once
/// Reads tables of text as exports write them.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "stats/base/file.hpp"

namespace test {

/// For each line after the header, a map from the header's names to the line's values.
using NamedRows = std::vector<std::map<std::string, std::string>>;

/// Splits at `separator` outside quotes and removes the quotes.
inline NamedRows read_table(const std::filesystem::path& path, char separator) {
  std::vector<std::vector<std::string>> lines{{""}};
  bool quoted = false;
  for (const char c : base::read_file(path, 1u << 30)) {
    if (c == '"')
      quoted = !quoted;
    else if (c == separator && !quoted)
      lines.back().emplace_back();
    else if (c == '\n' && !quoted)
      lines.push_back({""});
    else if (c != '\r')
      lines.back().back() += c;
  }
  lines.pop_back();
  NamedRows rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    rows.emplace_back();
    for (std::size_t j = 0; j < lines[0].size(); ++j) rows.back()[lines[0][j]] = lines[i].at(j);
  }
  return rows;
}

inline NamedRows read_csv(const std::filesystem::path& path) { return read_table(path, ','); }
inline NamedRows read_tsv(const std::filesystem::path& path) { return read_table(path, '\t'); }

}  // namespace test
