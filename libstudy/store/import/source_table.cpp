#include "libstudy/store/import/source_table.hpp"

#include <algorithm>
#include <cctype>
#include <map>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/json_problems.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

constexpr std::size_t most_source_bytes = 1 << 28;
/// JSON takes some ten times its size in memory.
constexpr std::size_t most_json_source_bytes = 1 << 25;

bool is_json_file(const std::filesystem::path& file) {
  std::string end = file.extension().string();
  for (char& c : end) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return end == ".json";
}

std::string json_field(const base::Json& value) {
  if (value.is_null()) return "";
  if (value.is_string()) return value.text();
  return value.dump();
}

}  // namespace

SourceTable::SourceTable(const std::filesystem::path& file) : file_(file) {
  const std::string text = base::read_file(file, most_source_bytes);
  sha256_ = base::sha256_hex(text);
  if (is_json_file(file))
    read_json(text);
  else
    csv_.emplace(file.string(), text);
}

void SourceTable::read_json(const std::string& text) {
  const auto fail = [&](const std::string& place, const std::string& problem) {
    throw base::Error(
        place, problem,
        "give a list of objects, one for each row, as jsPsych.data.get().json() writes it, or the "
        "table as CSV");
  };
  if (text.size() > most_json_source_bytes)
    fail(file_.string(), "has more than " + std::to_string(most_json_source_bytes >> 20) + " MiB");
  base::Json root;
  try {
    root = base::Json::parse(text);
  } catch (const base::JsonError& error) {
    const std::string problem = base::json_problem(error.what());
    const bool cut = problem.starts_with("it ends too early");
    throw base::Error(file_.string(), "is no whole JSON text: " + problem,
                      text.empty() ? "export it again: the file is empty"
                      : cut        ? "export it again: the file is cut short"
                                   : "export it again, or give the table as CSV");
  }
  if (const auto twice = base::repeated_key(text))
    throw base::Error(
        file_.string() + (twice->entry > 0 ? ": entry " + std::to_string(twice->entry) : ""),
        "has the key \"" + base::shortened(twice->key, 60) + "\" twice in one object",
        "correct the program that wrote the file, or remove one of the two: which value holds is not known");
  if (!root.is_array() || root.empty()) fail(file_.string(), "is no JSON list with entries");
  std::map<std::string, std::size_t> places;
  for (std::size_t i = 0; i < root.size(); ++i) {
    Row& row = rows_.emplace_back();
    row.line = static_cast<int>(i + 1);
    if (!root[i].is_object()) fail(place(row), "is no object");
    for (const auto& [key, value] : root[i].items()) {
      const auto [found, fresh] = places.try_emplace(key, names_.size());
      if (fresh) names_.push_back(key);
      row.fields.resize(std::max(row.fields.size(), found->second + 1));
      row.fields[found->second] = json_field(value);
    }
  }
  for (Row& row : rows_) row.fields.resize(names_.size());
}

std::size_t SourceTable::place_of(const std::string& column) const {
  if (csv_) {
    if (const auto place = csv_->find(column)) return *place;
  } else if (const auto found = std::find(names_.begin(), names_.end(), column); found != names_.end()) {
    return static_cast<std::size_t>(found - names_.begin());
  }
  throw base::Error(file_.string(), "has no column " + base::shortened(column),
                    "correct the mapping: " + base::use_one_of(column, names()));
}

std::string SourceTable::place(const Row& row) const {
  return file_.string() + (csv_ ? ":" : ": entry ") + std::to_string(row.line);
}

}  // namespace study
