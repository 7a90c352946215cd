#pragma once
/// Memory bandwidth of the back end: the reference for passes that only move bytes.

#include "libsim/exec/backend.hpp"

namespace sim {

/// Bytes read plus bytes written per second, in GB/s (1e9), of copies of 256 MiB within the back end's
/// memory: the median of several. Two methods are timed, the back end's own copy and a pass shared by all
/// threads, and the faster is returned. Needs 512 MiB while it runs. If memory does not suffice:
/// std::bad_alloc on the CPU, base::Error on a GPU. base::Error for a missing back end.
double copy_bandwidth_gb_s(Backend backend);

}  // namespace sim
