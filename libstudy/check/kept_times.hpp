#pragma once
/// Cache of a station's measured step times, so that they need not be measured before every session.

#include <filesystem>
#include <optional>
#include <string>

#include "libstudy/check/rehearsal.hpp"

namespace study {

/// Reads the times in `folder` under this key; none if missing, damaged or of another key.
std::optional<StepTimes> read_step_times(const std::filesystem::path& folder, const std::string& key);

/// Stores the times in one file per key, written by rename. An empty or unwritable folder is no error: the
/// next session measures again.
void keep_step_times(const std::filesystem::path& folder, const std::string& key, const StepTimes& times);

}  // namespace study
