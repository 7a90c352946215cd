#pragma once
/// State of the eyes between frames: their last G-buffers in the back end's memory, and their gazes, which
/// may get lost.

#include <array>
#include <cstdint>

#include "libsim/exec/gl_sharing.hpp"
#include "libsim/saliency/looks.hpp"
#include "libsim/saliency/sight.hpp"

namespace sim::SIM_BACKEND {

/// One eye or two.
struct Eyes {
  static constexpr int most = 2;
  Eye eye[most];
  int count = 0;
};

class SaliencyInput {
 public:
  /// Stores gazes and cameras and copies the pictures; without `pictures` the last ones remain. Returns
  /// false, and changes nothing, if a picture is in GL buffers that cannot be shared. base::Error: no eye or
  /// more than two, a camera that is not finite, a visual scale that is not positive, a G-buffer with
  /// incomplete arrays or without a perspective camera, GL buffers that are smaller than the picture.
  bool look(const Looks& looks, bool pictures = true);
  /// Degrees by which the gaze of `looks` (without an argument: of the last look()) has turned since
  /// mark_gazes(); the larger value of two eyes. A shift of the eye by s m adds atan(s), the angle of the
  /// shift at a distance of 1 m. A gaze that was valid at the mark and is lost now has turned by 0; one that
  /// was lost at the mark too is replaced by the view's axis. Before the first mark the result is 180.
  double turned_deg(const Looks& looks) const;
  double turned_deg() const;
  /// Stores the present gazes for turned_deg(). A gaze that has been lost for at most hold_s keeps its
  /// old mark if the mark was a valid gaze. Otherwise the mark of a lost gaze is the view's axis.
  void mark_gazes(double hold_s);
  /// Unmaps the GL buffers of the pictures that look() mapped. Required before GL draws.
  void give_back();
  /// Sets one eye with this camera, without a gaze or a picture. It applies until the first look().
  void look_by_default(const View& view);

  /// The eyes for the coming frame of dt_s. A lost gaze keeps its last direction for hold_s and then follows
  /// the view's axis.
  Eyes next_frame(double dt_s, double hold_s);
  /// Number of frames without a valid gaze, summed over the eyes.
  std::uint64_t gaze_lost() const { return gaze_lost_; }
  /// Where the pictures of the last look() with `pictures` set came from (GL memory or the host), and which
  /// simulation frame they show.
  SeenReport seen() const { return seen_; }
  /// Bytes used by the pictures.
  std::size_t bytes() const;
  /// Saves or restores the state that lasts beyond a frame (libsim/solver/state_archive.hpp).
  template <class Archive>
  void keep(Archive& archive) {
    archive(count_, gaze_lost_, seen_);
    for (auto& eye : eyes_) eye.keep(archive);
  }

 private:
  struct OneEye {
    Gaze gaze;
    View view;
    double visual_scale = 1;
    Vec3d marked{};        ///< direction at the last mark; 0: none
    Vec3d marked_place{};  ///< eye position at the last mark, m
    bool marked_valid = false;
    Vec3d last_direction{};  ///< of the last valid gaze; 0 if there was none
    double lost_s = 0;       ///< time since the last valid gaze
    View picture_view;
    GBufferView picture;
    Array<float> depth, normal;
    GlSharing sharing{GlSharing::Access::Read};

    template <class Archive>
    void keep(Archive& archive) {
      bool there = picture.depth != nullptr;
      archive(gaze, view, visual_scale, marked, marked_place, marked_valid, last_direction, lost_s,
              picture_view, there);
      if (!there) return;
      archive(picture.normal_stride, picture.width, picture.height, picture.radius_scale, depth, normal);
      if constexpr (Archive::reads) {
        const std::size_t pixels =
            static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
        if (depth.size() != pixels ||
            normal.size() != static_cast<std::size_t>(picture.normal_stride) * pixels)
          Archive::fail("holds a picture with arrays that do not fit its size in px");
        picture.depth = depth.data();
        picture.normal = normal.data();
      }
    }
    double turned_deg(const Gaze& to, const View& by) const;
    void take(const GBuffer& seen);
    void take(const GlPicture& shared);
  };
  std::array<OneEye, Eyes::most> eyes_;
  int count_ = 0;
  std::uint64_t gaze_lost_ = 0;
  SeenReport seen_;
};

}  // namespace sim::SIM_BACKEND
