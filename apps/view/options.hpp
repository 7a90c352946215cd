#pragma once
/// The options of vip-view.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libsim/ptpe/ptpe_file.hpp"
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
  std::string overlay = "none";                     ///< painted over the water; headless, several with commas
  std::string tau = "live";                         ///< live or fixed:X
  int levels = 4;                                   ///< N
  std::optional<double> alpha;                      ///< weight of the temporal feature; none = the preset's
  std::optional<int> iterations;                    ///< per substep; none = the scene's
  std::string camera = "view";                      ///< view | overview
  std::string ptpe;                                 ///< fitted.toml; empty = none
  std::optional<sim::SettingFile> setting;          ///< best.toml, the source of method, n_star, levels ...
  std::shared_ptr<const study::SweepTables> sweep;  ///< costs and errors of settings; null = not asked for
  std::string png_folder;                           ///< empty = no pictures
  base::PictureSize size{1280, 720};
  std::optional<int> frames;       ///< none: 100 headless; in a headset until it is left
  int every = 1;                   ///< number of frames per picture
  std::string display = "window";  ///< window | headless | openxr
  std::string clock = "real";      ///< of a headset: real | virtual
  bool explain = false;
  std::string effects_off;                          ///< words with commas: effects of the scene to turn off
  std::optional<std::vector<sim::Effect>> effects;  ///< to run; none = all but effects_off
};

/// A scene with its fluid at frame 0.
struct PreparedFluid {
  sim::Scene scene;                 ///< with the effects that run
  std::vector<sim::Effect> listed;  ///< effects that the file lists
  sim::Camera camera;
  std::optional<sim::PtpeFile> ptpe;
  std::unique_ptr<sim::Simulation> fluid;
  double finest_spacing_m = 0;   ///< 2 r_*
  bool follows_picture = false;  ///< levels depend on the last picture
  bool follows_rate = false;     ///< the solver uses the frame rate
  double frame_dt_s = 0;         ///< of the fluid
  sim::SolverSetting setting;    ///< in force at frame 0
};
/// What the renderer draws of a scene. Effects that cannot act in the method's water are left out.
sim::Scene drawn(const PreparedFluid& prepared);
/// Takes method, n_star, levels, alpha, iterations and tau from best.toml. Its other numbers apply as long as
/// method, n_star, levels and preset are unchanged.
void take_setting(ViewOptions& options, const std::string& path);

/// Lines with the sweep's results for a setting in this scene file; none without a sweep.
std::vector<std::string> price_lines(const ViewOptions& options, const sim::SolverSetting& setting,
                                     const sim::Scene& scene);

/// Reads and settles the scene and prints a summary, with the schedule if asked for. Calls `settling` with
/// (done, total) for each settling frame; if it is empty, shows a progress bar.
PreparedFluid prepare_fluid(const ViewOptions& options, const std::function<void(int, int)>& settling = {});

/// Runs the frames and writes the pictures, without a display.
void run_headless(const ViewOptions& options);
/// Runs in a headset through OpenXR until it is left; if there is none, says why and uses the desktop.
/// base::Error for later failures.
void run_in_headset(const ViewOptions& options);
/// Opens a window until it is closed. base::Error if this build or this machine has none.
void run_window(const ViewOptions& options);

}  // namespace apps
