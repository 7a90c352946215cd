#pragma once
/// The record of calibrations beside the solver's file: FILE.history.jsonl, one JSON object a line, oldest
/// first. The solver reads FILE alone.

#include <filesystem>
#include <string>

#include "stats/base/json.hpp"

namespace apps {

std::filesystem::path history_of(const std::filesystem::path& file);

/// Adds `entry` with the file's new `text`, its SHA-256 and the SHA-256 of the line before, so that a line
/// changed or taken out shows. A file that stands there and is not the newest of the record (written before
/// there was one, or changed by hand) is taken down first. The record grows as a whole or not at all.
/// base::Error when the record that stands is damaged or cannot be written; nothing is changed then.
void append_calibration(const std::filesystem::path& file, const std::string& text, const base::Json& entry);

}  // namespace apps
