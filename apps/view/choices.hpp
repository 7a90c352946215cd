#pragma once
/// Choices that the user of vip-view's window can change while it runs, and their consequences. The code
/// needs no window and no GL.

#include <string>
#include <vector>

#include "apps/view/options.hpp"

namespace apps {

/// Consequence of a changed choice for the running fluid.
enum class Change {
  Nothing,
  Numbers,  ///< the running fluid changes at the next frame: Simulation::change() and set_effects()
  Fluid     ///< a new fluid starts at frame 0
};
/// The consequence of changing `before` to `after`. Compares scene, method, preset, n_*, number of levels,
/// alpha, iterations and effects; the other options cannot change while a window is open.
Change change_between(const ViewOptions& before, const ViewOptions& after);

/// The paper's scenes that are installed, and the opened scene if it is another one.
std::vector<std::string> scenes_to_offer(const std::string& opened);
/// Name of a scene in the combo box: "single_dam" for "data/scenes/single_dam.toml".
std::string scene_title(const std::string& path);
/// The offered n_*: 1k to 128k in steps of a factor 2, and the current n_* if it is another; smallest first.
std::vector<std::string> sizes_to_offer(const std::string& n_star);

/// Times of the last frames, and the scale of their diagram.
class FrameStrip {
 public:
  static constexpr int length = 240;

  /// Adds the time of one frame, ms. Ignores values that are negative or not finite.
  void push(double ms);
  void clear() { *this = {}; }
  /// Top of the scale, ms: the smallest of 1, 2, 5, 10, 20, ... that no frame exceeds; 1 without frames.
  double scale_ms() const;
  /// Times of the last `length` frames, ms, as a ring that begins at oldest(); 0: no frame yet.
  const float* ms() const { return ms_; }
  int oldest() const { return next_; }

 private:
  float ms_[length] = {};
  int next_ = 0;
};

/// File name of a screenshot, such as "vip-view_faucet_Ours_0120.png".
std::string screenshot_name(const ViewOptions& options, int frame);

}  // namespace apps
