#pragma once
/// An OpenXR swapchain: the images through which a program passes one picture to the runtime.

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "libstudy/headset/picture_copy.hpp"
#include "libstudy/headset/session_handle.hpp"
#include "stats/base/picture_size.hpp"

namespace study {

/// A swapchain of a session. The destructor destroys it and needs the session's OpenGL context.
class Swapchain {
 public:
  /// base::Error if the runtime cannot make images of this format and size, or OpenGL cannot draw into them.
  Swapchain(const SessionHandle& session, std::int64_t format, int width_px, int height_px);
  ~Swapchain();
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;

  std::int64_t format() const { return format_; }
  /// Copies the part of a picture that has the image's size into the next image, and releases the image to
  /// the runtime. number: identifies the picture's content. Does nothing if the last call had the same part
  /// and the same number other than 0. base::Error if the runtime does not free an image within `limit`.
  void write(const sim::Offscreen& picture, const PicturePart& part, std::uint64_t number,
             std::chrono::nanoseconds limit);
  /// The whole image that was released last, for use in a layer.
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

/// Makes one swapchain for each size, all in the best offered format with which the runtime makes all of
/// them. base::Error if this fails with every format.
std::vector<std::unique_ptr<Swapchain>> make_swapchains(const SessionHandle& session,
                                                        const std::vector<base::PictureSize>& sizes);

}  // namespace study
