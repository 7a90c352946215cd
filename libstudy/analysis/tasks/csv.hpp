#pragma once
/// Lists of the results as CSV, with the same fields under the same names.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"

namespace study {

/// One line for each object of a list, as in RFC 4180. A nested object's fields are named outer_inner, an
/// interval's ends name_low and name_high. Other lists are left out, except lists of texts, which are joined
/// by spaces. Null is an empty field; numbers are not rounded; texts pass study::formula_guarded(). The
/// columns are those of any line, in the order of first appearance; for an empty list they are `if_empty`.
std::string csv_text(const Json& list, const std::vector<std::string>& if_empty = {});

/// The folders that write_csv_folder() fills: the given one first, then "apart_1" and so on within it for the
/// documents in "apart".
std::vector<std::filesystem::path> csv_folders(const Json& results, const std::filesystem::path& folder);

/// Writes every list of the results into csv_folders(), which must exist: task1_cells.csv and the like. Empty
/// or absent lists make no file, except that exclusions.csv is always written.
using WriteFile = std::function<void(const std::filesystem::path&, const std::string& bytes)>;
void write_csv_folder(const Json& results, const std::filesystem::path& folder, const WriteFile& write);

}  // namespace study
