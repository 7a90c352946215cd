#include "apps/bench/timed_run.hpp"

#include <utility>

#include "apps/common/program.hpp"
#include "libsim/solver/settled_state.hpp"
#include "libstudy/session/machine.hpp"

namespace apps {

std::unique_ptr<sim::Simulation> make_settled(const sim::Scene& scene, sim::SimulationOptions options) {
  options.cache = sim::default_cache_folder();
  Progress progress("settling", static_cast<std::size_t>(std::max(1, scene.settle_frames)));
  options.settling = [&](int done, int) { progress.update(static_cast<std::size_t>(done)); };
  return sim::make_simulation(scene, options);
}

std::string processor() {
  const std::string machine = study::describe_machine();
  const auto end = machine.find("; ");
  return end == std::string::npos ? machine : machine.substr(end + 2);
}

}  // namespace apps
