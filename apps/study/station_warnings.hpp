#pragma once
/// What is not as it should be of the station before a session: clock, place of the database, screen,
/// computer.

#include <filesystem>
#include <string>
#include <vector>

#include "apps/study/session_setup.hpp"
#include "libstudy/store/store.hpp"

namespace apps {

/// What speaks against the clock: `now` is before the day `built`, before `newest` (the latest time in the
/// database; empty: none) or more than a year after it. Empty: nothing does.
std::string clock_problem(const std::string& now, const std::string& newest, const std::string& built);

/// This and place_problems(), printed on stderr; the experimenter may go on. Called before anything of the
/// session is written.
std::vector<std::string> warn_of_station(study::Store& store, const std::filesystem::path& database);

/// Before the first step: writes those warnings into the log of each session, and at a window also what the
/// screen and the computer are like, which is printed. Returns all that is not as it should be.
std::vector<std::string> check_station(study::Store& store, const study::OpenRun& run,
                                       const study::Protocol& protocol, const SessionSetup& setup,
                                       const std::filesystem::path& database);

}  // namespace apps
