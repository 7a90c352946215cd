#pragma once
/// Spreads work over processes. Each command of the library runs in a child of its worker, so a worker must
/// have one thread.

#include <functional>
#include <string>
#include <vector>

namespace faults {

/// Calls work(worker, say) in `jobs` processes; passes each line given to `say` to `take` in this process,
/// one at a time. Returns true if all of them ended well.
bool spread(int jobs, const std::function<void(int, const std::function<void(const std::string&)>&)>& work,
            const std::function<void(const std::string&)>& take);

}  // namespace faults
