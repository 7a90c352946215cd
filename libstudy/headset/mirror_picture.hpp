#pragma once
/// The middle of a headset's left eye's view as one picture, for onlookers.

#include "libsim/gl/gl_program.hpp"
#include "libstudy/headset/frame_loop.hpp"

namespace study {

/// Draws the picture for a mirror. At every call, a context that shares the headset's pictures must be
/// current.
class MirrorPicture {
 public:
  /// Field of view of the picture, degrees from edge to edge: narrow enough for legible pages, so the edges
  /// of most headsets' fields of view are missing.
  static constexpr double field_deg = 60;
  static constexpr int side_px = 720;

  MirrorPicture();
  ~MirrorPicture();
  MirrorPicture(const MirrorPicture&) = delete;
  MirrorPicture& operator=(const MirrorPicture&) = delete;

  /// Draws the view; with_picture = false: stimuli are black. Returns false, without drawing, if the whole
  /// view would be black.
  bool draw(const SeenNow& seen, bool with_picture) const;
  /// Returns the drawn picture; waits until the drawing is done.
  sim::Image read() const { return drawn_.read(); }

 private:
  static void draw_in_strips();

  sim::GlProgram program_;
  sim::Offscreen drawn_;
  unsigned vertices_ = 0;
};

}  // namespace study
