#pragma once
/// Warnings about the station before a session: clock, location of the database, screen, computer.

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/runner/session_setup.hpp"
#include "libstudy/store/store.hpp"

namespace apps {

/// Describes what is wrong with the clock: `now` is before the day `built`, before `newest` (the latest time
/// in the database; empty: none) or more than a year after it. Empty: none.
std::string clock_problem(const std::string& now, const std::string& newest, const std::string& built);

/// Prints clock_problem() and place_problems() on stderr and returns them; the experimenter may go on. Call
/// before anything of the session is written.
std::vector<std::string> warn_of_station(study::Store& store, const std::filesystem::path& database);

/// Call before the first step: logs those warnings in each session; with a window, also logs and prints the
/// facts of screen and computer. Returns all warnings.
std::vector<std::string> check_station(study::Store& store, const study::OpenRun& run,
                                       const study::Protocol& protocol, const study::SessionSetup& setup,
                                       const std::filesystem::path& database);

}  // namespace apps
