#pragma once
/// Readers for exported folders: their files, tables and JSON.

#include <zlib.h>

#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "stats/base/file.hpp"
#include "stats/base/json.hpp"

namespace test {

using Rows = std::vector<std::vector<std::string>>;

inline std::set<std::string> files_below(const std::filesystem::path& folder) {
  std::set<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.insert(std::filesystem::relative(entry.path(), folder).string());
  }
  return files;
}

/// Null if the file is missing or cannot be parsed.
inline base::Json json_at(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path)) return nullptr;
  return base::parse_json(base::read_file(path, 1u << 24));
}

inline std::string unzipped(const std::filesystem::path& path) {
  std::string text(1u << 24, '\0');
  gzFile file = gzopen(path.c_str(), "rb");
  const int size = file ? gzread(file, text.data(), static_cast<unsigned>(text.size())) : -1;
  if (file) gzclose(file);
  text.resize(static_cast<std::size_t>(std::max(size, 0)));
  return text;
}

/// Rows of a TSV file, which has no quotes.
inline Rows tsv_rows(const std::string& text) {
  Rows rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    auto& row = rows.emplace_back(1);
    for (const char c : line) {
      if (c == '\t')
        row.emplace_back();
      else
        row.back() += c;
    }
  }
  return rows;
}

/// Rows of a CSV file by RFC 4180.
inline Rows csv_rows(const std::string& text) {
  Rows rows(1, {""});
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"')
      rows.back().back() += text[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && c == ',')
      rows.back().emplace_back();
    else if (!quoted && c == '\n')
      rows.push_back({""});
    else if (quoted || c != '\r')
      rows.back().back() += c;
  }
  if (rows.back() == std::vector<std::string>{""}) rows.pop_back();
  return rows;
}

}  // namespace test
