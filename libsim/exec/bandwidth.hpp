#pragma once
/// How fast the back end's memory moves bytes: what passes that only move them are held against.

#include "libsim/exec/backend.hpp"

namespace sim {

/// Bytes read plus bytes written a second, in GB/s (1e9), of copies of 256 MiB from one place of the back
/// end's memory to another: the median of several. Two ways are timed, the back end's own copy and a pass
/// that all threads share, and the faster is told. Needs 512 MiB for as long as it runs. Where there
/// is no room for them: std::bad_alloc on the CPU, base::Error on a GPU. base::Error for a back end that is
/// not there.
double copy_bandwidth_gb_s(Backend backend);

}  // namespace sim
