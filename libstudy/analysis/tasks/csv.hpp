#pragma once
/// Writes the lists of the results as CSV tables; columns have the names of the JSON fields.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"

namespace study {

/// CSV text by RFC 4180 with one line for each object of `list`. A nested object's fields are named
/// outer_inner, an interval's ends name_low and name_high. A list of texts is joined by spaces; other lists
/// are left out. Null is an empty field. Numbers are not rounded. A text other than "-Inf" that a spreadsheet
/// would read as a formula gets an apostrophe in front (formula_guarded()). There is a column for each field
/// that any line has, in the order of first appearance. A null gets no column if another line has an interval
/// of the same name. An empty list has the columns `if_empty`.
std::string csv_text(const Json& list, const std::vector<std::string>& if_empty = {});

/// The folders that write_csv_folder() fills: `folder`, and within it "apart_1", "apart_2" and so on for the
/// documents in the results' list "apart".
std::vector<std::filesystem::path> csv_folders(const Json& results, const std::filesystem::path& folder);

/// A function that writes `bytes` to the file at the given path.
using WriteFile = std::function<void(const std::filesystem::path&, const std::string& bytes)>;
/// Writes each list of the results as a table, such as task1_cells.csv, into csv_folders(), which must exist.
/// An empty or absent list makes no file; only exclusions.csv is always written.
void write_csv_folder(const Json& results, const std::filesystem::path& folder, const WriteFile& write);

}  // namespace study
