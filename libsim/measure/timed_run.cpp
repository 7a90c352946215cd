#include "libsim/measure/timed_run.hpp"

#include <utility>

#include "libsim/solver/settled_state.hpp"
#include "stats/base/machine.hpp"
#include "stats/base/progress.hpp"

namespace measure {

std::unique_ptr<sim::Simulation> make_settled(const sim::Scene& scene, sim::SimulationOptions options) {
  options.cache = sim::default_cache_folder();
  base::Progress progress("settling", static_cast<std::size_t>(std::max(1, scene.settle_frames)));
  options.settling = [&](int done, int) { progress.update(static_cast<std::size_t>(done)); };
  return sim::make_simulation(scene, options);
}

std::string processor() {
  const std::string machine = base::describe_machine();
  const auto end = machine.find("; ");
  return end == std::string::npos ? machine : machine.substr(end + 2);
}

}  // namespace measure
