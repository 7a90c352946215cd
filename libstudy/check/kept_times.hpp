#pragma once
/// Files that cache step times (the times to compute and to draw each content step of a stimulus) measured on
/// a station, so that a later session need not measure again.

#include <filesystem>
#include <optional>
#include <string>

#include "libstudy/check/rehearsal.hpp"

namespace study {

/// Reads the step times that keep_step_times() stored in `folder` under `key`. None if the path `folder` is
/// empty, or if the file is missing, is damaged or contains another key.
std::optional<StepTimes> read_step_times(const std::filesystem::path& folder, const std::string& key);

/// Stores the step times in `folder`, in one file per key. An older file of the key is replaced atomically.
/// Stores nothing if the path `folder` is empty or the folder cannot be written; this is no error, since the
/// next session then measures again.
void keep_step_times(const std::filesystem::path& folder, const std::string& key, const StepTimes& times);

}  // namespace study
