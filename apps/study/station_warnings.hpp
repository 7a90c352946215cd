#pragma once
/// Warnings about a station before a session, about its clock, database folder, screen and computer.

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/runner/session_setup.hpp"
#include "libstudy/store/store.hpp"

namespace apps {

/// The problem of this computer's clock: `now` is before `built` (the day of the build), more than a minute
/// before `newest`, or more than a year after `newest`. newest: latest time in the database; empty: no data.
/// Returns an empty text if there is no problem.
std::string clock_problem(const std::string& now, const std::string& newest, const std::string& built);

/// Prints clock_problem() and place_problems() (of the database's location) on stderr and returns these
/// warnings, which do not prevent the session. Call before anything of the session is written.
std::vector<std::string> warn_of_station(study::Store& store, const std::filesystem::path& database);

/// Logs the warnings of warn_of_station() in each session. With a window, also logs and prints the facts of
/// screen and computer. Returns all warnings. Call before the first unit.
std::vector<std::string> check_station(study::Store& store, const study::OpenRun& run,
                                       const study::Protocol& protocol, const study::SessionSetup& setup,
                                       const std::filesystem::path& database);

}  // namespace apps
