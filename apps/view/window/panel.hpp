#pragma once
/// The panel of vip-view's window, with values and controls, drawn with Dear ImGui.

#include <cstdint>
#include <string>
#include <vector>

#include "apps/view/choices.hpp"
#include "apps/view/effect_switches.hpp"
#include "apps/view/options.hpp"
#include "apps/view/overlay.hpp"
#include "apps/view/pass_means.hpp"
#include "stats/fps_window.hpp"
#include "stats/ptpe/ptpe.hpp"

struct GLFWwindow;

namespace apps {

/// Values that the panel shows.
struct Figures {
  int frame = 0;
  std::int64_t particles = 0;
  double frame_ms = 0;  ///< time of the last frame
  stats::FpsMoments fps;
  double tau = 0, beta = 1;  ///< tau: fixed, or computed from the rate of the shown frames; beta from tau
  std::string model;         ///< "fixed" for a fixed tau; otherwise the source of the PTPE model's a and b
  FrameStrip strip;
  std::string legend;              ///< legend of the values painted over the water
  std::vector<std::string> price;  ///< lines with cost and errors of the setting; empty without a sweep
  PassMeans passes;                ///< filled only while the schedule is shown
  std::string said;                ///< text of the last error, or the file name of the last screenshot
};

/// Values that the user sets in the panel.
struct Controls {
  ViewOptions chosen;
  double alpha = 0;    ///< weight of the temporal feature in the running fluid's saliency
  int iterations = 1;  ///< iterations per substep of the running fluid
  bool paused = false;
  bool step_once = false;
  bool mouse_gaze = true;  ///< false: the gaze follows the scene's gaze keys
  bool screenshot = false;
  bool restart = false;
  OverlayKind overlay = OverlayKind::None;
  bool schedule = false;               ///< true: the schedule is shown and its passes are timed
  std::vector<EffectSwitch> switches;  ///< one per effect that the scene lists
};

class Panel {
 public:
  /// `opened`: the options of the command line.
  Panel(GLFWwindow* window, const ViewOptions& opened);
  ~Panel();
  Panel(const Panel&) = delete;
  Panel& operator=(const Panel&) = delete;

  /// Draws the panel over the current framebuffer.
  void draw(Controls& controls, const Figures& figures);
  /// Draws the progress of a new fluid: a text and a bar from 0 to 1.
  void draw_progress(const std::string& text, float done);
  /// True if the mouse is over the panel. The position of the mouse is then not used as gaze.
  bool has_mouse() const;
  /// True while the user types a number in the panel.
  bool has_keys() const;

 private:
  void draw_fluid(Controls& controls);
  void draw_numbers(Controls& controls);
  void draw_effects(Controls& controls);
  void draw_schedule(const PassMeans& passes);

  std::vector<std::string> scenes_, methods_, sizes_;
  int size_ = 0;    ///< position of the n_* slider while it is dragged
  int levels_ = 4;  ///< position of the slider of N, the number of levels, while it is dragged
};

}  // namespace apps
