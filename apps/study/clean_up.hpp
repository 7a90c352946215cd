#pragma once
/// Withdrawals by the commands, and what is printed after a withdrawal or a merge.

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/chores.hpp"
#include "libstudy/store/study_file.hpp"

namespace apps {

void print_list(const char* title, const std::vector<std::string>& lines);

/// Prints what is missing in a study that is read with --incomplete.
void print_lacking(const std::filesystem::path& database, const std::string& lacking);

/// Prints the result of a clean-up.
void print_clean_up(const study::CleanUp& done);

/// Withdraws, and prints all that was deleted. base::Error if something could not be deleted.
void withdraw_and_tell(const std::filesystem::path& database, const std::string& participant);

/// base::Error if a requested withdrawal is still to be done, so that none of that person's data go into an
/// export.
void check_no_withdrawal_is_due(const study::StudyFile& study);

}  // namespace apps
