#include "libsim/scene/extent.hpp"
#include "libsim/simulation.hpp"
#include "libsim/solver/settled_state.hpp"
#include "stats/base/error.hpp"

namespace sim {

// Each back end is a separate namespace, compiled from the same source (libsim/exec/space.hpp).
namespace cpu {
std::unique_ptr<Simulation> make_simulation(const Scene& scene, const SimulationOptions& options);
int least_substeps(const Scene& scene, const SimulationOptions& options);
}  // namespace cpu
#ifdef SIM_HAS_CUDA
namespace cuda {
std::unique_ptr<Simulation> make_simulation(const Scene& scene, const SimulationOptions& options);
}
#endif

namespace {
std::unique_ptr<Simulation> make_on_backend(const Scene& scene, const SimulationOptions& options) {
#ifdef SIM_HAS_CUDA
  if (options.backend == Backend::Cuda) return cuda::make_simulation(scene, options);
#endif
  if (options.backend == Backend::Cuda) choose_backend("cuda");
  check_memory(options.method, options.n_star, available_memory_bytes());
  return cpu::make_simulation(scene, options);
}
}  // namespace

// Both back ends have the same minimum, so the CPU's function serves for both.
int least_substeps(const Scene& scene, const SimulationOptions& options) {
  return cpu::least_substeps(scene, options);
}

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const SimulationOptions& options) {
  const bool resumes = !options.resume_from.empty();
  if (resumes && options.start) {
    throw base::Error("start of the simulation",
                      "is given twice: as particles, and as the saved state " + options.resume_from.string(),
                      "give only the particles, or only the saved state");
  }
  if (options.start || resumes || scene.settle_frames == 0) return make_on_backend(scene, options);
  const std::string key = options.cache.empty() ? "" : settled_key(scene, options);
  SimulationOptions rested = options;
  if (!key.empty()) rested.start = read_settled(options.cache, key);
  if (!rested.start) {
    rested.start = make_on_backend(scene, options)->read_state();
    if (!key.empty()) write_settled(options.cache, key, *rested.start);
  }
  // The run starts from these particles, which are ordered by id, also if the state was just settled and not
  // read from the cache. So runs with and without the cache write identical files.
  return make_on_backend(scene, rested);
}

}  // namespace sim
