#pragma once
/// The rules of Psych-DS whose violation is an error in its schema 1.5.1 (psych-DS, schema_model/versions).

#include <regex>

#include "tests/common/data_set.hpp"

namespace test {

/// The rules that a data set breaks, one line each.
inline std::vector<std::string> psych_ds_broken_by(const std::filesystem::path& folder) {
  std::vector<std::string> broken;
  const auto require = [&](bool kept, const std::string& rule) {
    if (!kept) broken.push_back(rule);
  };
  const auto json = json_at(folder / "dataset_description.json");
  if (!json.is_object()) return {"MISSING_DATASET_DESCRIPTION"};
  require(json.value("@context", "").starts_with("https://schema.org"), "UNKNOWN_NAMESPACE");
  require(json.value("@type", "") == "Dataset", "INCORRECT_DATASET_TYPE");
  for (const char* key : {"name", "description"})
    require(json.value(key, "") != "", std::string("JSON_KEY_REQUIRED ") + key);
  require(json.contains("variableMeasured"), "JSON_KEY_REQUIRED variableMeasured");
  std::set<std::string> described, found;
  for (const auto& variable : json.value("variableMeasured", base::Json::array())) {
    require(variable.value("@type", "") == "PropertyValue", "OBJECT_TYPE_MISSING " + variable.dump());
    require(variable.value("description", "") != "", "no description " + variable.dump());
    require(described.insert(variable.value("name", "")).second, "described twice " + variable.dump());
  }
  require(std::filesystem::exists(folder / "README.md"), "MISSING_README_DOC");
  const std::string keyword =
      "(study|site|subject|session|task|condition|trial|stimulus|description)-[a-zA-Z0-9]+";
  const std::regex name_of_data("data/(.*/)?" + keyword + "(_" + keyword + ")*_data\\.csv");
  for (const std::string& name : files_below(folder)) {
    if (!name.starts_with("data/")) continue;
    require(std::regex_match(name, name_of_data), "FILENAME_KEYWORD_FORMATTING_ERROR " + name);
    const Rows rows = csv_rows(base::read_file(folder / name, 1u << 26));
    if (rows.empty() || rows[0][0].empty()) {
      broken.push_back("CSV_HEADER_MISSING " + name);
      continue;
    }
    for (const auto& row : rows) require(row.size() == rows[0].size(), "CSV_HEADER_LENGTH_MISMATCH " + name);
    require(std::set<std::string>(rows[0].begin(), rows[0].end()).size() == rows[0].size(),
            "CSV_HEADER_REPEATED " + name);
    found.insert(rows[0].begin(), rows[0].end());
  }
  require(!found.empty(), "MISSING_DATAFILE");
  for (const std::string& column : found)
    require(described.contains(column), "CSV_COLUMN_MISSING_FROM_METADATA " + column);
  for (const std::string& column : described)
    require(found.contains(column), "VARIABLE_MISSING_FROM_CSV_COLUMNS " + column);
  return broken;
}

}  // namespace test
