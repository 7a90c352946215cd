#pragma once
/// The station, as it stands in a session's record.

#include <string>

namespace study {

/// Operating system, processor and number of cores; no name that tells the machine or its user.
std::string describe_machine();
/// Name and offset of the local time zone, e.g. "CET +0100".
std::string local_time_zone();

}  // namespace study
