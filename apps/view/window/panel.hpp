#pragma once
/// The panel of the window: what is shown and what can be chosen, in Dear ImGui.

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

/// What the panel shows.
struct Figures {
  int frame = 0;
  std::int64_t particles = 0;
  double frame_ms = 0;  ///< of the last frame
  stats::FpsMoments fps;
  double tau = 0, beta = 1;  ///< of the frames shown
  std::string model;         ///< where a and b come from
  FrameStrip strip;
  std::string legend;              ///< of what is painted over the water
  std::vector<std::string> price;  ///< what the setting costs and errs by; empty: no sweep was given
  PassMeans passes;                ///< while the schedule is shown
  std::string said;                ///< the last error, or where a screenshot went
};

/// What the panel sets.
struct Controls {
  ViewOptions chosen;
  double alpha = 0;    ///< those of the fluid that runs
  int iterations = 1;  ///< likewise
  bool paused = false;
  bool step_once = false;
  bool mouse_gaze = true;  ///< else the scene's gaze keys
  bool screenshot = false;
  bool restart = false;
  OverlayKind overlay = OverlayKind::None;
  bool schedule = false;               ///< shown, and so timed
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
  /// Draws how far a new fluid is: a text and a bar from 0 to 1.
  void draw_progress(const std::string& text, float done);
  /// Whether the mouse is at the panel and so not a gaze.
  bool has_mouse() const;
  /// Whether a number is being typed.
  bool has_keys() const;

 private:
  void draw_fluid(Controls& controls);
  void draw_numbers(Controls& controls);
  void draw_effects(Controls& controls);
  void draw_schedule(const PassMeans& passes);

  std::vector<std::string> scenes_, methods_, sizes_;
  int size_ = 0;    ///< of the slider of n_*, while it is dragged
  int levels_ = 4;  ///< likewise of N
};

}  // namespace apps
