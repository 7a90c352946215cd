#pragma once
/// Withdrawals by the commands, with a report of all that was deleted.

#include <filesystem>
#include <string>

#include "libstudy/store/study_file.hpp"

namespace apps {

/// base::Error if something could not be deleted.
void withdraw_and_tell(const std::filesystem::path& database, const std::string& participant);

/// base::Error if a requested withdrawal is still to be done, so that none of that person's data go into an
/// export.
void check_no_withdrawal_is_due(const study::StudyFile& study);

}  // namespace apps
