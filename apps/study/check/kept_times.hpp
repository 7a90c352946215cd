#pragma once
/// What was measured of a station, kept so that it need not be measured before every session.

#include <filesystem>
#include <optional>
#include <string>

#include "apps/study/check/rehearsal.hpp"

namespace apps {

/// What `folder` holds under this key; none when there is nothing, or it is damaged or of another key.
std::optional<StepTimes> read_step_times(const std::filesystem::path& folder, const std::string& key);

/// In a file of its own, written by rename. A folder that is empty or cannot be written is no error: the next
/// session measures again.
void keep_step_times(const std::filesystem::path& folder, const std::string& key, const StepTimes& times);

}  // namespace apps
