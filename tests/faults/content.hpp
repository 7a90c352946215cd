#pragma once
/// What the files of a study hold, as lines of text that can be compared: nothing in them depends on when a
/// command ran or how often it was begun.

#include <filesystem>
#include <string>
#include <vector>

namespace faults {

namespace fs = std::filesystem;
using Lines = std::vector<std::string>;

/// What sessions came to: each session's state, its units, answers and last showings. Equal for a session
/// that was cut and resumed and one that was not.
Lines session_content(const fs::path& database);
/// Every row of every table but the log of events and the register of exports, without times of day.
Lines database_content(const fs::path& database);
/// What each participant allows.
Lines permission_content(const fs::path& database);
/// The personal file beside a database; nothing where there is none.
Lines personal_content(const fs::path& database);
/// Names and bytes of all files of a folder; files that name a time of day or a path without those lines.
Lines folder_content(const fs::path& folder);

/// A row of each answer as it was acknowledged, with its number and time: it must never change.
Lines answer_rows(const fs::path& database);
/// "P01 3" for each unit that is done.
Lines done_units(const fs::path& database);
/// True when a plan of sessions stands in the database.
bool is_planned(const fs::path& database);
/// True when `needle` stands in the bytes of any file of the folder, at any depth; in `where`: which.
bool stands_in(const fs::path& folder, const std::string& needle, std::string& where);

Lines operator+(Lines all, const Lines& more);
/// What `all` lacks of `part`, at most three lines of it; empty: nothing.
std::string missing(const Lines& part, const Lines& all);
/// How two contents differ, in words; empty: they do not.
std::string difference(const Lines& wanted, const Lines& found);

}  // namespace faults
