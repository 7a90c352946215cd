#include <cctype>

#include "libsim/simulation.hpp"
#include "stats/base/error.hpp"

namespace sim {

std::string backend_name(Backend backend) { return backend == Backend::Cpu ? "cpu" : "cuda"; }

}  // namespace sim
