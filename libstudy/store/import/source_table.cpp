#include "libstudy/store/import/source_table.hpp"

#include <algorithm>
#include <cctype>
#include <map>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/json_keys.hpp"
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

/// Throws what is wrong with a text that is no JSON, and where. message: of base::JsonError.
[[noreturn]] void fail_as_broken_json(const std::string& file, const std::string& text,
                                      const std::string& message) {
  const auto says = [&](const char* words) { return message.find(words) != std::string::npos; };
  const bool cut = says("unexpected end of input") || says("missing closing quote") || says("empty input");
  std::string problem = cut                             ? "it ends too early"
                        : says("expected end of input") ? "it goes on behind its end"
                        : says("UTF-8")                 ? "it has bytes that are not UTF-8"
                        : says("nested deeper than")    ? message
                                                        : "it has a mistake";
  std::string where;
  if (const std::size_t line = message.find("line "), end = message.find(':', line);
      line != std::string::npos && end != std::string::npos)
    where = ", at " + message.substr(line, end - line);
  throw base::Error(file, "is no whole JSON text: " + problem + where,
                    text.empty() ? "export it again: the file is empty"
                    : cut        ? "export it again: the file is cut short"
                                 : "export it again, or give the table as CSV");
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
    fail_as_broken_json(file_.string(), text, error.what());
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
