#include "libsim/simulation.hpp"

namespace sim {

std::string backend_name(Backend backend) { return backend == Backend::Cpu ? "cpu" : "cuda"; }

}  // namespace sim
