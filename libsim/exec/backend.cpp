#include "libsim/exec/backend.hpp"

#include "stats/base/error.hpp"

namespace sim {

#ifdef SIM_HAS_CUDA
namespace cuda {
/// The reason why no CUDA device responds; empty if one responds.
std::string device_problem();
std::int64_t device_bytes_taken();
std::string device_name();
}  // namespace cuda
#endif

namespace {
std::string cuda_problem() {
#ifdef SIM_HAS_CUDA
  return cuda::device_problem();
#else
  return "this program was built without CUDA";
#endif
}

#ifdef SIM_HAS_CUDA
constexpr const char* cuda_mend = "use --backend cpu or auto, or a machine with an NVIDIA driver";
#else
constexpr const char* cuda_mend = "use --backend cpu or auto, or build with nvcc 12.0 or newer";
#endif
}  // namespace

Backend choose_backend(std::string_view name) {
  if (name == "cpu") return Backend::Cpu;
  if (name != "cuda" && name != "auto") {
    throw base::Error("--backend " + std::string(name), "is not known", "use cpu, cuda or auto");
  }
  const std::string problem = cuda_problem();
  if (problem.empty()) return Backend::Cuda;
  if (name == "auto") return Backend::Cpu;
  throw base::Error("--backend cuda", problem, cuda_mend);
}

std::optional<std::int64_t> device_bytes_taken([[maybe_unused]] Backend backend) {
#ifdef SIM_HAS_CUDA
  if (backend == Backend::Cuda) return cuda::device_bytes_taken();
#endif
  return {};
}

std::string device_name([[maybe_unused]] Backend backend) {
#ifdef SIM_HAS_CUDA
  if (backend == Backend::Cuda) return cuda::device_name();
#endif
  return {};
}

}  // namespace sim
