#pragma once
/// Parameters of Table 1's protocol; the defaults are those of the paper and of the scenes.

#include <string>

#include "libsim/measure/cells.hpp"
#include "libsim/measure/render_timer.hpp"
#include "libsim/solver/settled_state.hpp"

namespace measure {

struct Table1Options : TableOptions {
  int checkpoints = 0;       ///< number of the scene's checkpoints to use; 0 = all
  int gazes = 3;             ///< gaze points per checkpoint
  int repeats = 5;           ///< perturbed starts per gaze point
  int frames_after = 5;      ///< from a checkpoint to the compared picture
  int cumul_frames = 200;    ///< length of the film; 0 = no film
  int film_starts = 1;       ///< starts of the film, an ulp apart
  int projections = 50;      ///< largest number of projections of a start
  bool unperturbed = false;  ///< starts are not perturbed: HiRes must then equal itself
  base::PictureSize size{1280, 720};
  std::string pictures;                          ///< folder for side-by-side pictures; empty = none
  std::string checkpoints_to, checkpoints_from;  ///< folders for checkpoint_file.hpp; empty = none
  std::string cells;                             ///< file for cell_scores.hpp; empty = none
  std::string paired_with;                       ///< file of that kind from another run; empty = none
};

/// Options that all runs of a method share.
inline sim::SimulationOptions run_options(const Table1Options& options, const sim::CellScene& scene,
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

}  // namespace measure
