#include <algorithm>
#include <cstdio>

#include "apps/common/program.hpp"
#include "apps/view/options.hpp"
#include "apps/view/overlay.hpp"
#include "libsim/ptpe/tolerance_switch.hpp"
#include "libsim/scene/fill.hpp"
#include "libsim/solver/settled_state.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace apps {

PreparedFluid prepare_fluid(const ViewOptions& options, const std::function<void(int, int)>& settling) {
  PreparedFluid prepared;
  prepared.scene = sim::read_scene(base::find_input(options.scene));
  prepared.camera = options.camera == "overview" ? prepared.scene.overview : prepared.scene.view;
  if (!options.ptpe.empty()) prepared.ptpe = sim::read_ptpe_file(options.ptpe);
  sim::SimulationOptions choice;
  choice.cache = sim::default_cache_folder();
  choice.method = sim::parse_method(options.method);
  choice.n_star = sim::parse_n_star(options.n_star);
  choice.readings = sim::readings_of(sim::parse_preset(options.preset));
  choice.levels = options.levels;
  if (options.alpha) choice.readings.alpha = *options.alpha;
  choice.iterations = options.iterations.value_or(0);
  // In a window they may be chosen later.
  choice.saliency_parts = options.overlay != "none" || options.display == "window";
  choice.temporal.fixed_tau = sim::parse_tau(options.tau);
  if (prepared.ptpe) choice.temporal.model = prepared.ptpe->model;
  prepared.finest_spacing_m =
      sim::resolution_of(prepared.scene, choice.method, choice.n_star).finest_spacing_m;
  prepared.follows_picture = sim::traits_of(choice.method).target == sim::TargetSource::Saliency;
  choice.backend = sim::choose_backend(options.backend);
  {
    Progress progress("settling", static_cast<std::size_t>(std::max(1, prepared.scene.settle_frames)));
    choice.settling =
        settling ? settling : [&](int done, int) { progress.update(static_cast<std::size_t>(done)); };
    prepared.fluid = sim::make_simulation(prepared.scene, choice);
  }
  std::printf("%s, %s, n_* %s: %lld particles on %s\n", prepared.scene.name.c_str(),
              sim::method_name(choice.method).c_str(), options.n_star.c_str(),
              static_cast<long long>(prepared.fluid->particle_count()),
              sim::backend_name(choice.backend).c_str());
  if (options.explain) std::printf("%s\n", prepared.fluid->explain().c_str());
  return prepared;
}

}  // namespace apps
