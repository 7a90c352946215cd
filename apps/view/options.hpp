#pragma once
/// What vip-view was asked for.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/picture_size.hpp"
#include "apps/common/setting_file.hpp"
#include "apps/common/sweep/setting_price.hpp"
#include "libsim/ptpe/ptpe_file.hpp"
#include "libsim/simulation.hpp"

namespace apps {

struct ViewOptions {
  std::string scene;
  std::string method = "HiRes";
  std::string n_star = "16k";
  std::string backend = "auto";
  std::string preset = "tuned";
  std::string overlay = "none";        ///< what is painted over the water; headless, several with commas
  std::string tau = "live";            ///< live or fixed:X
  int levels = 4;                      ///< N
  std::optional<double> alpha;         ///< weight of the temporal feature; none = the preset's
  std::optional<int> iterations;       ///< a substep; none = the scene's
  std::string camera = "view";         ///< view | overview
  std::string ptpe;                    ///< fitted.toml; empty = none
  std::optional<SettingFile> setting;  ///< best.toml, which method, n_star, levels ... were taken from
  std::shared_ptr<const SweepTables> sweep;  ///< what settings cost and err by; none = not asked
  std::string png_folder;                    ///< empty = no pictures
  PictureSize size{1280, 720};
  std::optional<int> frames;       ///< none: 100 headless, in a headset until it is left
  int every = 1;                   ///< a picture every so many frames
  std::string display = "window";  ///< window | headless | openxr
  std::string clock = "real";      ///< of a headset: real | virtual
  bool explain = false;
  std::string effects_off;  ///< words with commas: effects of the scene that do not run
  std::optional<std::vector<sim::Effect>> effects;  ///< that run; none = the scene's but effects_off
};

/// A scene with its fluid at frame 0.
struct PreparedFluid {
  sim::Scene scene;                 ///< with the effects that run
  std::vector<sim::Effect> listed;  ///< that the file lists
  sim::Camera camera;
  std::optional<sim::PtpeFile> ptpe;
  std::unique_ptr<sim::Simulation> fluid;
  double finest_spacing_m = 0;   ///< 2 r_*
  bool follows_picture = false;  ///< levels come from what was drawn last
  bool follows_rate = false;     ///< the solver reads the rate of the frames
  double frame_dt_s = 0;         ///< of the fluid
  SolverSetting setting;         ///< in force at frame 0
};
/// Takes over what best.toml names: method, n_star, levels, alpha, iterations and tau. Its other numbers hold
/// for as long as method, n_star, levels and preset stay as it has them.
void take_setting(ViewOptions& options, const std::string& path);

/// What the sweep of the options says of a setting in this scene file, in lines; none without a sweep.
std::vector<std::string> price_lines(const ViewOptions& options, const SolverSetting& setting,
                                     const sim::Scene& scene);

/// Reads the scene, settles it and prints what came of it, the schedule too when asked to. `settling` hears
/// of each frame of that with (done, total); when it is empty a progress bar shows them.
PreparedFluid prepare_fluid(const ViewOptions& options, const std::function<void(int, int)>& settling = {});

/// Runs the frames and writes the pictures, without a display.
void run_headless(const ViewOptions& options);
/// In a headset by OpenXR, until it is left; on the desktop where there is none, and says why. base::Error
/// for what goes wrong later.
void run_in_headset(const ViewOptions& options);
/// Opens a window until it is closed. base::Error when this build or this machine has none.
void run_window(const ViewOptions& options);

}  // namespace apps
