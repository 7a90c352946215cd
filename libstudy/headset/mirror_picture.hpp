#pragma once
/// The middle of a headset's left eye's view as one picture, for onlookers.

#include "libsim/gl/gl_program.hpp"
#include "libstudy/headset/frame_loop.hpp"

namespace study {

/// Needs a current context that shares the headset's pictures, at every call.
class MirrorPicture {
 public:
  /// Degrees from edge to edge: a page is legible, and the edges of most fields of view are cut off.
  static constexpr double field_deg = 60;
  static constexpr int side_px = 720;

  MirrorPicture();
  ~MirrorPicture();
  MirrorPicture(const MirrorPicture&) = delete;
  MirrorPicture& operator=(const MirrorPicture&) = delete;

  /// with_picture: if false, the stimulus is black. Returns false and draws nothing if all is black.
  bool draw(const SeenNow& seen, bool with_picture) const;
  /// Waits until the drawing is done.
  sim::Image read() const { return drawn_.read(); }

 private:
  static void draw_in_strips();

  sim::GlProgram program_;
  sim::Offscreen drawn_;
  unsigned vertices_ = 0;
};

}  // namespace study
