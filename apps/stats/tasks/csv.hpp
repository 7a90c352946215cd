#pragma once
/// Lists of the results as CSV: the same fields under the same names, so that both agree.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/stats/data/json_parts.hpp"

namespace apps {

/// One line for each object of a list, RFC 4180. A nested object's fields are named outer_inner, an
/// interval's ends name_low and name_high; other lists are left out unless of texts, which are joined by
/// spaces. Null is an empty field; nothing is rounded; texts are study::formula_guarded(). Columns are those
/// that any line has, in the order of first appearance; `if_empty` are those of an empty list.
std::string csv_text(const Json& list, const std::vector<std::string>& if_empty = {});

/// The folders that write_csv_folder() fills, the given one first: "apart_1" within it and so on are of what
/// stands apart.
std::vector<std::filesystem::path> csv_folders(const Json& results, const std::filesystem::path& folder);

/// Writes every list of the results into csv_folders(), which are there: task1_cells.csv and the like. Lists
/// that are empty or absent make no file; exclusions.csv is always there.
using WriteFile = std::function<void(const std::filesystem::path&, const std::string& bytes)>;
void write_csv_folder(const Json& results, const std::filesystem::path& folder, const WriteFile& write);

}  // namespace apps
