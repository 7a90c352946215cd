#pragma once
/// Path of the record of calibrations beside the solver's file: FILE.history.jsonl, one JSON object per line,
/// oldest first. The solver reads only FILE.

#include <filesystem>
#include <string>

#include "stats/base/json.hpp"

namespace study {

std::filesystem::path history_of(const std::filesystem::path& file);

/// Appends `entry` with the file's new `text`, its SHA-256 and the SHA-256 of the line before, so that a
/// changed or removed line is detected. If the existing file is not the newest of the record (written before
/// the record existed, or changed by hand), it is recorded first. The record is extended as a whole or not at
/// all. base::Error if the existing record is damaged or cannot be written; nothing is changed then.
void append_calibration(const std::filesystem::path& file, const std::string& text, const base::Json& entry);

}  // namespace study
