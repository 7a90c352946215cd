#include <algorithm>

#include "libsim/scene/settled_state.hpp"
#include "libsim/simulation.hpp"
#include "stats/base/error.hpp"

namespace sim {

// Each back end is a namespace of its own, compiled from one text (libsim/exec/space.hpp).
namespace cpu {
std::unique_ptr<Simulation> make_simulation(const Scene& scene, const SimulationOptions& options);
}
#ifdef SIM_HAS_CUDA
namespace cuda {
std::unique_ptr<Simulation> make_simulation(const Scene& scene, const SimulationOptions& options);
/// Empty when a device answers, otherwise why none does.
std::string device_problem();
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

namespace {
std::unique_ptr<Simulation> make_on_backend(const Scene& scene, const SimulationOptions& options) {
#ifdef SIM_HAS_CUDA
  if (options.backend == Backend::Cuda) return cuda::make_simulation(scene, options);
#endif
  if (options.backend == Backend::Cuda) choose_backend("cuda");
  return cpu::make_simulation(scene, options);
}
}  // namespace

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const SimulationOptions& options) {
  if (options.start || options.cache.empty() || scene.settle_frames == 0)
    return make_on_backend(scene, options);
  const std::string key = settled_key(scene, options);
  SimulationOptions from_cache = options;
  from_cache.start = read_settled(options.cache, key);
  auto simulation = make_on_backend(scene, from_cache);
  if (!from_cache.start) write_settled(options.cache, key, simulation->read_state());
  return simulation;
}

}  // namespace sim
