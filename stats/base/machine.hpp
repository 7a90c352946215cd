#pragma once
/// Description of the computer for the record of a session.

#include <string>

namespace base {

/// Operating system, processor model and number of logical processors, without the names of the machine and
/// its user.
std::string describe_machine();
/// Name and offset of the local time zone, e.g. "CET +0100".
std::string local_time_zone();

}  // namespace base
