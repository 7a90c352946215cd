#pragma once
/// The options of vip-view.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libsim/ptpe/ptpe_file.hpp"
#include "libsim/render/fluid_renderer.hpp"
#include "libsim/setting/setting_file.hpp"
#include "libsim/simulation.hpp"
#include "libstudy/sweep/setting_price.hpp"
#include "stats/base/picture_size.hpp"

namespace apps {

struct ViewOptions {
  std::string scene;
  std::string method = "HiRes";
  std::string n_star = "16k";
  std::string backend = "auto";
  std::string preset = "tuned";
  std::string overlay = "none";             ///< values painted over the water; headless: one or several
  std::string tau = "live";                 ///< tolerance tau: "live" (from frame times) or "fixed:X"
  int levels = 4;                           ///< number of levels, N
  std::optional<double> alpha;              ///< temporal feature's weight in saliency; none = the preset's
  std::optional<int> iterations;            ///< solver iterations per substep; none = the scene's
  std::string surface = "ellipsoids";       ///< ellipsoids | spheres: how the particles are drawn
  std::string camera = "view";              ///< view | overview
  std::string ptpe;                         ///< file of a fitted PTPE model (a, b of tau); empty = none
  std::optional<sim::SettingFile> setting;  ///< the setting file that take_setting() read
  std::shared_ptr<const study::SweepTables> sweep;  ///< costs and errors of settings; null = not requested
  std::string png_folder;                           ///< folder for pictures; empty = no pictures
  base::PictureSize size{1280, 720};
  std::optional<int> frames;       ///< number of frames; none: 100 headless, unlimited in a headset
  int every = 1;                   ///< interval between pictures, frames
  std::string display = "window";  ///< window | headless | openxr
  std::string clock = "real";      ///< clock of a headset: real | virtual
  bool explain = false;
  std::string effects_off;                          ///< words with commas: effects of the scene to turn off
  std::optional<std::vector<sim::Effect>> effects;  ///< effects that run; none = all but effects_off
};

/// A scene with its fluid at frame 0.
struct PreparedFluid {
  sim::Scene scene;                 ///< the scene, with only the effects that run
  std::vector<sim::Effect> listed;  ///< all effects that the scene file lists
  sim::Camera camera;
  std::optional<sim::PtpeFile> ptpe;
  std::unique_ptr<sim::Simulation> fluid;
  double finest_spacing_m = 0;   ///< rest spacing of the finest particles: twice their radius r_*
  bool follows_picture = false;  ///< true: the levels depend on the last picture
  bool follows_rate = false;     ///< true: the solver uses the measured frame rate
  double frame_dt_s = 0;         ///< duration of a frame of the fluid, s
  sim::SolverSetting setting;    ///< solver setting at frame 0
};
/// The scene for the renderer: without the effects that cannot act in the method's water.
sim::Scene drawn(const PreparedFluid& prepared);
/// Sets method, n_star, levels, alpha, iterations and tau from a setting file. The other numbers of the file
/// apply as long as method, n_star, levels and preset are unchanged, also after a change of alpha or
/// iterations.
void take_setting(ViewOptions& options, const std::string& path);

/// Lines with the cost and the errors of a setting in this scene, as measured by a sweep (runs of many
/// settings, options.sweep); no lines without a sweep. If the preset is not "tuned", one line that says that
/// the setting was not measured.
std::vector<std::string> price_lines(const ViewOptions& options, const sim::SolverSetting& setting,
                                     const sim::Scene& scene);

/// Reads the scene, makes and settles its fluid, and prints a summary; with options.explain, also the
/// schedule of passes. Calls `settling` with (done, total) for each settling frame; if `settling` is empty,
/// shows a progress bar.
PreparedFluid prepare_fluid(const ViewOptions& options, const std::function<void(int, int)>& settling = {});

/// The renderer's options that the program's options choose.
sim::RenderOptions render_options(const ViewOptions& options);

/// Runs the frames without a display, writes the pictures and prints times.
void run_headless(const ViewOptions& options);
/// Shows the scene in a headset through OpenXR until the person leaves, Ctrl-C is pressed or the frames of
/// options.frames have run. If there is no headset, prints the reason and opens a window; on the virtual
/// clock throws. base::Error for an overlay and for later failures.
void run_in_headset(const ViewOptions& options);
/// Shows the scene in a window until the window is closed. base::Error if this build or this machine has no
/// windows.
void run_window(const ViewOptions& options);

}  // namespace apps
