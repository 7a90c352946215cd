#include "libsim/exec/bandwidth.hpp"

namespace sim {

// Each back end is a separate namespace, compiled from the same source (libsim/exec/space.hpp).
namespace cpu {
double copy_bandwidth_gb_s();
}
#ifdef SIM_HAS_CUDA
namespace cuda {
double copy_bandwidth_gb_s();
}
#endif

double copy_bandwidth_gb_s(Backend backend) {
#ifdef SIM_HAS_CUDA
  if (backend == Backend::Cuda) return cuda::copy_bandwidth_gb_s();
#endif
  if (backend == Backend::Cuda) choose_backend("cuda");
  return cpu::copy_bandwidth_gb_s();
}

}  // namespace sim
