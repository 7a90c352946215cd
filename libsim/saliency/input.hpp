#pragma once
/// Eyes between frames: their last G-buffers in the back end's memory, and what is done about a lost gaze.

#include <array>
#include <cstdint>

#include "libsim/exec/gl_sharing.hpp"
#include "libsim/saliency/eye.hpp"
#include "libsim/saliency/looks.hpp"

namespace sim::SIM_BACKEND {

/// One eye or two.
struct Eyes {
  static constexpr int most = 2;
  Eye eye[most];
  int count = 0;
};

class SaliencyInput {
 public:
  /// Takes gazes and cameras and copies the pictures; without `pictures` the last ones stay. False, and
  /// nothing is taken, when a picture lies in GL buffers that cannot be shared. base::Error: no eye or more
  /// than two, a camera that is not finite, a G-buffer whose arrays are not whole.
  bool look(const Looks& looks, bool pictures = true);
  /// Degrees by which a gaze has turned since mark_gazes(), in these looks or in the last ones: the larger of
  /// two eyes. An eye that was shifted counts as one that turned, by the angle of the shift at one metre.
  /// Without a gaze the view's axis counts. One that gets lost has not turned; before the first mark all have
  /// by 180.
  double turned_deg(const Looks& looks) const;
  double turned_deg() const;
  /// Not of a gaze that was lost less than hold_s ago: it is where it was.
  void mark_gazes(double hold_s);
  /// Gives GL the buffers of the pictures back, which look() keeps. They must be back before GL draws.
  void give_back();
  /// The eye of a program that never calls look().
  void look_by_default(const View& view);

  /// The eyes for the coming frame of dt_s. A lost gaze stays where it last was for hold_s and then follows
  /// the view's axis.
  Eyes next_frame(double dt_s, double hold_s);
  /// Eye-frames without a valid gaze.
  std::uint64_t gaze_lost() const { return gaze_lost_; }
  /// How the pictures of the last look() came.
  SeenReport seen() const { return seen_; }
  /// Bytes of the pictures.
  std::size_t bytes() const;
  /// What outlives a frame (libsim/solver/state_archive.hpp).
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
    Vec3d marked{};        ///< direction at the last mark; 0: there was none
    Vec3d marked_place{};  ///< of the eye, m
    bool marked_valid = false;
    Vec3d last_direction{};  ///< of the last valid gaze; 0 when there was none
    double lost_s = 0;       ///< since then
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
          Archive::fail("holds a picture that is not whole");
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
