#pragma once
/// What the window lets one choose while it runs, and what a choice costs. No window, no GL.

#include <string>
#include <vector>

#include "apps/view/options.hpp"

namespace apps {

/// What must be done about new choices.
enum class Change {
  Nothing,
  Numbers,  ///< Simulation::change() and set_effects(), from the next frame on
  Fluid     ///< another fluid, from frame 0
};
/// Compares scene, method, preset, n_*, N, alpha, iterations and effects; the rest of the options stays while
/// a window is open.
Change change_between(const ViewOptions& before, const ViewOptions& after);

/// The paper's scenes that are here, and the one that was opened when it is another.
std::vector<std::string> scenes_to_offer(const std::string& opened);
/// "single_dam" for "data/scenes/single_dam.toml".
std::string scene_title(const std::string& path);
/// n_* from 1k to 128k by doubling, and the one in use when it is another; smallest first.
std::vector<std::string> sizes_to_offer(const std::string& n_star);

/// Times of the last frames, and the scale that shows them.
class FrameStrip {
 public:
  static constexpr int length = 240;

  /// ms >= 0; anything else is left out.
  void push(double ms);
  void clear() { *this = {}; }
  /// Top of the scale, ms: the least of 1, 2, 5, 10, 20, ... that no frame exceeds; 1 when there is none.
  double scale_ms() const;
  const float* ms() const { return ms_; }  ///< `length` values, 0 where no frame was
  int oldest() const { return next_; }

 private:
  float ms_[length] = {};
  int next_ = 0;
};

/// "vip-view_faucet_Ours_0120.png".
std::string screenshot_name(const ViewOptions& options, int frame);

}  // namespace apps
