#pragma once
/// Work spread over processes: each command of the library runs in a child of its worker, which must have one
/// thread.

#include <functional>
#include <string>
#include <vector>

namespace faults {

/// Calls work(worker, say) in `jobs` processes; each line that is said comes to `take` in this one, one at a
/// time. Returns whether all of them ended well.
bool spread(int jobs, const std::function<void(int, const std::function<void(const std::string&)>&)>& work,
            const std::function<void(const std::string&)>& take);

}  // namespace faults
