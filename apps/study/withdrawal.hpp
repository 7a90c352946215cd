#pragma once
/// A withdrawal as the commands do it, with a word about all that was deleted.

#include <filesystem>
#include <string>

#include "libstudy/store/study_file.hpp"

namespace apps {

/// base::Error when something is left that could not be deleted.
void withdraw_and_tell(const std::filesystem::path& database, const std::string& participant);

/// base::Error when somebody's wish is still to be carried out: nothing of theirs goes into an export.
void check_no_withdrawal_is_due(const study::StudyFile& study);

}  // namespace apps
