#pragma once
/// What the middle of a headset's left eye sees, as one picture: for those who look on.

#include "apps/common/headset/frame_loop.hpp"
#include "libsim/render/gl_program.hpp"

namespace apps {

/// Needs a context that shares the headset's pictures, always.
class MirrorPicture {
 public:
  /// Degrees from edge to edge: a page is legible then, and the edges of most fields of view are cut.
  static constexpr double field_deg = 60;
  static constexpr int side_px = 720;

  MirrorPicture();
  ~MirrorPicture();
  MirrorPicture(const MirrorPicture&) = delete;
  MirrorPicture& operator=(const MirrorPicture&) = delete;

  /// with_picture: else what a stimulus drew is black. False, and nothing is drawn, where all is.
  bool draw(const SeenNow& seen, bool with_picture) const;
  /// Waits until it is drawn.
  sim::Image read() const { return drawn_.read(); }

 private:
  static void draw_in_strips();

  sim::GlProgram program_;
  sim::Offscreen drawn_;
  unsigned vertices_ = 0;
};

}  // namespace apps
