#pragma once
/// The numbers of Table 1's protocol; the defaults are those of the paper and of the scenes.

#include <string>

#include "apps/bench/cells.hpp"
#include "apps/bench/render_timer.hpp"
#include "libsim/solver/settled_state.hpp"

namespace apps {

struct Table1Options : TableOptions {
  int checkpoints = 0;       ///< the scene's first so many; 0 = all
  int gazes = 3;             ///< points at each
  int repeats = 5;           ///< perturbed starts of each
  int frames_after = 5;      ///< from a checkpoint to the picture that is compared
  int cumul_frames = 200;    ///< of the film; 0 = no film
  int film_starts = 1;       ///< of the film, an ulp apart
  int projections = 50;      ///< of a start, at most
  bool unperturbed = false;  ///< starts are not moved: HiRes must then equal itself
  PictureSize size{1280, 720};
  std::string pictures;                          ///< folder for side by side pictures; empty = none
  std::string checkpoints_to, checkpoints_from;  ///< folders of checkpoint_file.hpp; empty = none
  std::string cells;                             ///< file for cell_scores.hpp; empty = none
  std::string paired_with;                       ///< such a file of another run; empty = none
};

/// What all runs of a method have in common.
inline sim::SimulationOptions run_options(const Table1Options& options, const CellScene& scene,
                                          const CellSize& size, sim::Preset preset, sim::MethodKind method) {
  sim::SimulationOptions out;
  out.method = method;
  out.n_star = size.n_star;
  out.backend = sim::choose_backend(options.backend);
  out.readings = sim::readings_of(preset);
  out.cache = sim::default_cache_folder();
  if (sim::traits_of(method).temporal)
    out.temporal.fixed_tau = tau_of(options.tau, scene.name, size.word, method);
  return out;
}

}  // namespace apps
