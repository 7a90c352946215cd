#pragma once
/// The protocol of Table 1: its parameters, the checkpoints of the reference method HiRes
/// (checkpoint_source.cpp), the scores of single pictures (stills.cpp), and SSIM-cumul and both flickers,
/// which compare all methods frame by frame with HiRes (film.cpp).

#include <functional>
#include <string>
#include <vector>

#include "libsim/measure/cells.hpp"
#include "libsim/measure/checkpoint.hpp"
#include "libsim/measure/contact_sheet.hpp"
#include "libsim/measure/onlooker.hpp"
#include "libsim/measure/render_timer.hpp"
#include "libsim/measure/scores.hpp"
#include "libsim/solver/settled_state.hpp"

namespace measure {

/// Options of `vip-bench table1`.
struct Table1Options : TableOptions {
  int checkpoints = 0;       ///< number of the scene's checkpoints to use; 0 = all
  int gazes = 3;             ///< gaze points per checkpoint
  int repeats = 5;           ///< perturbed starts per gaze point
  int frames_after = 5;      ///< frames from a checkpoint to the compared picture
  int cumul_frames = 200;    ///< frames of the comparison frame by frame (film.cpp); 0 = none
  int film_starts = 1;       ///< number of runs of that comparison; their starts differ by an ulp
  int projections = 50;      ///< maximum number of constraint projections that relax a start
  bool unperturbed = false;  ///< starts are not perturbed, except from the film's second start on
  base::PictureSize size{1280, 720};
  std::string pictures;                          ///< folder for side-by-side pictures; empty = none
  std::string checkpoints_to, checkpoints_from;  ///< folders to write and read checkpoints; empty = none
  std::string cells;                             ///< file to write the scores of each picture; empty = none
  std::string paired_with;                       ///< file `cells` of another run to compare; empty = none
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

// Checkpoints from a run of HiRes (the reference method, all particles finest), or from the files of an
// earlier run.

/// Frames of the scene's checkpoints that the options select.
std::vector<int> checkpoint_frames(const sim::CellScene& scene, const Table1Options& options);

/// Digests of the checkpoints in --checkpoints-from; empty without the option. base::Error if
/// read_checkpoint() refuses one.
std::vector<std::string> stored_digests(const sim::CellScene& scene, const CellSize& size,
                                        const Table1Options& options);

/// Reads the checkpoints from --checkpoints-from, or else runs HiRes from its settled state, drawn by `eye`,
/// and also stores them in --checkpoints-to if given.
std::vector<Checkpoint> take_checkpoints(const sim::CellScene& scene, const CellSize& size,
                                         const Table1Options& options, Onlooker& eye);

// Scores of single pictures: from one state of HiRes to each method's picture a few frames later.

/// Quality of a method's starts after the projections that relax them.
struct StartQuality {
  sim::MethodKind method{};
  sim::Preset preset{};
  sim::RelaxedStart worst;     ///< largest number of projections and largest compression of all starts
  double particles_share = 0;  ///< mean of number of particles / (8 n_*)
  int starts = 0;
};

struct StillResult {
  std::vector<ScoreBlock> blocks;  ///< one per preset
  std::vector<StartQuality> starts;
};

/// A block without values: the methods, checkpoints and number of repeats to compare.
ScoreBlock empty_block(const sim::CellScene& scene, const CellSize& size, sim::Preset preset,
                       const Table1Options& options);

/// Number of runs that run_stills() makes, for a progress line.
std::size_t still_runs(const sim::CellScene& scene, const Table1Options& options, std::size_t presets);

/// The protocol of single pictures: HiRes, the reference method, runs from its settled state. At each
/// checkpoint every method starts from that state, coarsened to the method's targets and projected, looks at
/// one gaze point and at the checkpoint's picture, and is compared `frames_after` frames later with HiRes
/// from the same checkpoint. Repeats perturb the state by an ulp (checkpoint.hpp) and reseed the choice of
/// active particles; HiRes from perturbed states shows the differences that chaos alone causes. The masks of
/// the fovea and of salient pixels come from the HiRes picture and its saliency with Preset::Tuned, the same
/// for all methods. The mask of the fluid is grown_union() of the water in both pictures. Needs a current
/// context; calls `done` after each run.
StillResult run_stills(const sim::CellScene& scene, const CellSize& size, const Table1Options& options,
                       const std::vector<sim::Preset>& presets, const std::function<void()>& done,
                       SheetWriter& sheets);

// The film: all methods from frame 0 on.

/// Runs the methods in lockstep, with the gaze on the scene's keys, and adds Metric::SsimCumul (mean SSIM of
/// frames 1 .. cumul_frames), Metric::Flicker and Metric::FlickerPeriphery (means over frames 2 ..
/// cumul_frames) to the block's methods, one cell for each of film_starts. HiRes is compared with itself from
/// a perturbed settled state (with options.unperturbed from the same one); from the second start on, all
/// methods start from perturbed states. Needs a current context.
void run_film(const sim::CellScene& scene, const CellSize& size, const Table1Options& options,
              ScoreBlock& block);

}  // namespace measure
