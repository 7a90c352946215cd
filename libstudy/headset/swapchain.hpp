#pragma once
/// A runtime's swapchain for one picture.

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "libstudy/headset/picture_copy.hpp"
#include "libstudy/headset/session_handle.hpp"
#include "stats/base/picture_size.hpp"

namespace study {

/// The destructor destroys the swapchain and needs the session's context.
class Swapchain {
 public:
  /// base::Error if the runtime does not make such images, or OpenGL cannot draw into them.
  Swapchain(const SessionHandle& session, std::int64_t format, int width_px, int height_px);
  ~Swapchain();
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;

  std::int64_t format() const { return format_; }
  /// Copies a part of a picture, of the image's size, into the next image and releases that to the runtime.
  /// Does nothing if the last image holds that part of the picture of this number; 0: a new picture each
  /// time. base::Error if the runtime holds all images for longer than `limit`.
  void write(const sim::Offscreen& picture, const PicturePart& part, std::uint64_t number,
             std::chrono::nanoseconds limit);
  /// The whole image, for a layer.
  XrSwapchainSubImage image() const;

 private:
  void make_images();
  void clear();
  std::uint32_t acquire(std::chrono::nanoseconds limit) const;

  const SessionHandle& session_;
  std::int64_t format_;
  int width_px_, height_px_;
  XrSwapchain swapchain_ = XR_NULL_HANDLE;
  std::vector<CopyTarget> images_;
  std::unique_ptr<PictureCopy> copy_;
  PicturePart last_part_;
  std::uint64_t last_number_ = 0;
};

/// Makes one swapchain per size, all of the best offered format that can really be made. base::Error if there
/// is none.
std::vector<std::unique_ptr<Swapchain>> make_swapchains(const SessionHandle& session,
                                                        const std::vector<base::PictureSize>& sizes);

}  // namespace study
