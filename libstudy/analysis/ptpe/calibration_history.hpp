#pragma once
/// The record of all calibrations beside the solver's file FILE: FILE.history.jsonl, one JSON object per
/// line, oldest first. The solver reads only FILE.

#include <filesystem>
#include <string>

#include "stats/base/json.hpp"

namespace study {

std::filesystem::path history_of(const std::filesystem::path& file);

/// Appends one line to the record of `file`: `entry`, the file's new `text`, the SHA-256 of `text` and the
/// SHA-256 of the line before. By this chain the change or removal of any line but the last is detected. If
/// the content of `file` is not that of the last line (it was written before the record existed, or changed
/// by hand), the content is recorded first. The record is replaced atomically. base::Error if the record is
/// damaged or cannot be written; nothing is changed then.
void append_calibration(const std::filesystem::path& file, const std::string& text, const base::Json& entry);

}  // namespace study
