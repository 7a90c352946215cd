#pragma once
/// The window's panel of figures and controls, in Dear ImGui.

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
  double frame_ms = 0;  ///< of the last frame
  stats::FpsMoments fps;
  double tau = 0, beta = 1;  ///< of the frames shown
  std::string model;         ///< source of a and b
  FrameStrip strip;
  std::string legend;              ///< of the values painted over the water
  std::vector<std::string> price;  ///< cost and errors of the setting; empty without a sweep
  PassMeans passes;                ///< only while the schedule is shown
  std::string said;                ///< the last error, or the path of a screenshot
};

/// Values that the panel sets.
struct Controls {
  ViewOptions chosen;
  double alpha = 0;    ///< of the running fluid
  int iterations = 1;  ///< of the running fluid
  bool paused = false;
  bool step_once = false;
  bool mouse_gaze = true;  ///< if false, the scene's gaze keys
  bool screenshot = false;
  bool restart = false;
  OverlayKind overlay = OverlayKind::None;
  bool schedule = false;               ///< shown, and therefore timed
  std::vector<EffectSwitch> switches;  ///< of the scene's effects, also while a slider is dragged
};

class Panel {
 public:
  /// `opened` is the scene of the command line.
  Panel(GLFWwindow* window, const ViewOptions& opened);
  ~Panel();
  Panel(const Panel&) = delete;
  Panel& operator=(const Panel&) = delete;

  /// Draws it over the current framebuffer.
  void draw(Controls& controls, const Figures& figures);
  /// Draws the progress of a new fluid: a text and a bar from 0 to 1.
  void draw_progress(const std::string& text, float done);
  /// True if the mouse is over the panel, so that it is not a gaze.
  bool has_mouse() const;
  /// True while a number is typed.
  bool has_keys() const;

 private:
  void draw_fluid(Controls& controls);
  void draw_numbers(Controls& controls);
  void draw_effects(Controls& controls);
  void draw_schedule(const PassMeans& passes);

  std::vector<std::string> scenes_, methods_, sizes_;
  int size_ = 0;    ///< position of the n_* slider while it is dragged
  int levels_ = 4;  ///< of the N slider, likewise
};

}  // namespace apps
