#pragma once
/// Description of the computer for the record of a session.

#include <string>

namespace base {

/// Operating system, processor and number of cores; no name of the machine or its user.
std::string describe_machine();
/// Name and offset of the local time zone, e.g. "CET +0100".
std::string local_time_zone();

}  // namespace base
