#pragma once
/// Deletes the data of participants who withdraw, for several commands, and prints the results of a
/// withdrawal or a merge.

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/chores.hpp"
#include "libstudy/store/study_file.hpp"

namespace apps {

void print_list(const char* title, const std::vector<std::string>& lines);

/// Prints `lacking`, the description of the data that an incomplete study lacks; nothing if empty.
void print_lacking(const std::filesystem::path& database, const std::string& lacking);

/// Prints from which files the clean-up removed a person's data, which files it deleted, and which clean-ups
/// failed and why.
void print_clean_up(const study::CleanUp& done);

/// Deletes the data of a participant and prints what was deleted. base::Error if something could not be
/// deleted.
void withdraw_and_tell(const std::filesystem::path& database, const std::string& participant);

/// base::Error if a requested withdrawal has not been carried out, so that no export contains data of a
/// person who asked for deletion.
void check_no_withdrawal_is_due(const study::StudyFile& study);

}  // namespace apps
