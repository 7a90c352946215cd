#pragma once
/// Content of a study's files as comparable lines of text, independent of when a command ran and how often it
/// was started.

#include <filesystem>
#include <string>
#include <vector>

namespace faults {

namespace fs = std::filesystem;
using Lines = std::vector<std::string>;

/// Results of sessions: each session's state, its units, its answers, and the last presentation of each
/// trial. A session that was interrupted and resumed has the same lines as one that was not.
Lines session_content(const fs::path& database);
/// Every row of every table except the register of exports, without times of day. Of the log of events, only
/// the events of a session, except "resumed".
Lines database_content(const fs::path& database);
/// The permissions of each participant.
Lines permission_content(const fs::path& database);
/// Rows of the file of personal data beside a database; empty if there is none.
Lines personal_content(const fs::path& database);
/// Name and SHA-256 of each file in a folder except export.sha256. Lines that may hold a time of day or a
/// path are left out of the hash.
Lines folder_content(const fs::path& folder);

/// One row per acknowledged answer, with its number and time: it must never change.
Lines answer_rows(const fs::path& database);
/// Participant and position of each finished unit, such as "P01 3".
Lines done_units(const fs::path& database);
/// True if the database has a plan of sessions.
bool is_planned(const fs::path& database);
/// True if any file of the folder, at any depth, contains `needle`; `where` gets the file.
bool stands_in(const fs::path& folder, const std::string& needle, std::string& where);

Lines operator+(Lines all, const Lines& more);
/// Lines of `part` that `all` lacks: the first three, and the number of further lines; empty if none.
std::string missing(const Lines& part, const Lines& all);
/// The differences of two contents as text; empty if equal.
std::string difference(const Lines& wanted, const Lines& found);

}  // namespace faults
