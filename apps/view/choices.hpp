#pragma once
/// Choices that the window offers while it runs, and their consequences. No window, no GL.

#include <string>
#include <vector>

#include "apps/view/options.hpp"

namespace apps {

/// What a changed choice requires.
enum class Change {
  Nothing,
  Numbers,  ///< Simulation::change() and set_effects(), from the next frame on
  Fluid     ///< a new fluid, from frame 0
};
/// Compares scene, method, preset, n_*, N, alpha, iterations and effects; the other options cannot change
/// while a window is open.
Change change_between(const ViewOptions& before, const ViewOptions& after);

/// The paper's scenes that are installed, and the opened scene if it is another one.
std::vector<std::string> scenes_to_offer(const std::string& opened);
/// "single_dam" for "data/scenes/single_dam.toml".
std::string scene_title(const std::string& path);
/// n_* from 1k to 128k by doubling, and the current one if it is another; smallest first.
std::vector<std::string> sizes_to_offer(const std::string& n_star);

/// Times of the last frames, and the scale to draw them with.
class FrameStrip {
 public:
  static constexpr int length = 240;

  /// Values that are not >= 0 are ignored.
  void push(double ms);
  void clear() { *this = {}; }
  /// Top of the scale, ms: the smallest of 1, 2, 5, 10, 20, ... that no frame exceeds; 1 without frames.
  double scale_ms() const;
  const float* ms() const { return ms_; }  ///< `length` values, 0 for missing frames
  int oldest() const { return next_; }

 private:
  float ms_[length] = {};
  int next_ = 0;
};

/// "vip-view_faucet_Ours_0120.png".
std::string screenshot_name(const ViewOptions& options, int frame);

}  // namespace apps
