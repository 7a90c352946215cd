#include "libstudy/headset/swapchain.hpp"

#include "stats/base/error.hpp"

namespace study {

namespace {
constexpr std::chrono::milliseconds image_wait{100};
}

Swapchain::Swapchain(const SessionHandle& session, std::int64_t format, int width_px, int height_px)
    : session_(session), format_(format), width_px_(width_px), height_px_(height_px) {
  XrSwapchainCreateInfo info{};
  info.type = XR_TYPE_SWAPCHAIN_CREATE_INFO;
  info.usageFlags = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_SAMPLED_BIT |
                    XR_SWAPCHAIN_USAGE_TRANSFER_DST_BIT;
  info.format = format;
  info.sampleCount = info.faceCount = info.arraySize = info.mipCount = 1;
  info.width = static_cast<std::uint32_t>(width_px);
  info.height = static_cast<std::uint32_t>(height_px);
  session.call<PFN_xrCreateSwapchain>("xrCreateSwapchain", session.get(), &info, &swapchain_);
  try {
    make_images();
    copy_ = std::make_unique<PictureCopy>(format);
  } catch (...) {
    clear();
    throw;
  }
}

Swapchain::~Swapchain() { clear(); }

void Swapchain::clear() {
  copy_.reset();
  for (const CopyTarget& image : images_) glDeleteFramebuffers(1, &image.framebuffer);
  session_.destroy<PFN_xrDestroySwapchain>("xrDestroySwapchain", swapchain_);
}

void Swapchain::make_images() {
  XrSwapchainImageOpenGLKHR blank{};
  blank.type = XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR;
  constexpr const char* call = "xrEnumerateSwapchainImages";
  for (const auto& image :
       read_array<XrSwapchainImageOpenGLKHR>(call, blank, [&](auto capacity, auto*count, auto*values) {
         return session_.attempt<PFN_xrEnumerateSwapchainImages>(
             call, swapchain_, capacity, count, reinterpret_cast<XrSwapchainImageBaseHeader*>(values));
       })) {
    CopyTarget& made = images_.emplace_back(CopyTarget{image.image, 0, width_px_, height_px_});
    glCreateFramebuffers(1, &made.framebuffer);
    glNamedFramebufferTexture(made.framebuffer, GL_COLOR_ATTACHMENT0, image.image, 0);
    if (glCheckNamedFramebufferStatus(made.framebuffer, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE) continue;
    throw base::Error("headset", "OpenGL cannot draw into images of " + gl_format_name(format_),
                      "update the graphics driver");
  }
}

std::uint32_t Swapchain::acquire(std::chrono::nanoseconds limit) const {
  std::uint32_t index = 0;
  XrSwapchainImageAcquireInfo acquire{};
  acquire.type = XR_TYPE_SWAPCHAIN_IMAGE_ACQUIRE_INFO;
  session_.call<PFN_xrAcquireSwapchainImage>("xrAcquireSwapchainImage", swapchain_, &acquire, &index);
  XrSwapchainImageWaitInfo wait{};
  wait.type = XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO;
  wait.timeout = std::chrono::nanoseconds(image_wait).count();
  const auto deadline = std::chrono::steady_clock::now() + limit;
  do {
    // XR_TIMEOUT_EXPIRED is a success code: the image is not free yet.
    if (session_.call<PFN_xrWaitSwapchainImage>("xrWaitSwapchainImage", swapchain_, &wait) !=
        XR_TIMEOUT_EXPIRED)
      return index;
  } while (std::chrono::steady_clock::now() < deadline);
  throw DisplayGone(CutCause::Hang, "headset", "the runtime does not release an image for the next picture",
                    "restart the headset's software; vip-study resume continues a session");
}

void Swapchain::write(const sim::Offscreen& picture, const PicturePart& part, std::uint64_t number,
                      std::chrono::nanoseconds limit) {
  // Unchanged content needs no copy: a layer keeps showing the image that was released last.
  if (number != 0 && number == last_number_ && part == last_part_) return;
  copy_->copy(picture, part, images_.at(acquire(limit)));
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  XrSwapchainImageReleaseInfo release{};
  release.type = XR_TYPE_SWAPCHAIN_IMAGE_RELEASE_INFO;
  session_.call<PFN_xrReleaseSwapchainImage>("xrReleaseSwapchainImage", swapchain_, &release);
  last_number_ = number;
  last_part_ = part;
}

XrSwapchainSubImage Swapchain::image() const { return {swapchain_, {{0, 0}, {width_px_, height_px_}}, 0}; }

std::vector<std::unique_ptr<Swapchain>> make_swapchains(const SessionHandle& session,
                                                        const std::vector<base::PictureSize>& sizes) {
  const std::vector<std::int64_t> formats = picture_formats(session.formats());
  if (formats.empty()) {
    throw base::Error("headset", "the runtime offers no format of pictures that OpenGL draws into",
                      "make another OpenXR runtime the active one, such as Monado or SteamVR");
  }
  for (const std::int64_t format : formats) {
    try {
      std::vector<std::unique_ptr<Swapchain>> made;
      for (const base::PictureSize& size : sizes)
        made.push_back(std::make_unique<Swapchain>(session, format, size.width, size.height));
      return made;
    } catch (const HeadsetLost&) {
      throw;
    } catch (const base::Error&) {
      if (format == formats.back()) throw;  // the runtime may refuse a listed format: tries the next one
    }
  }
  return {};
}

}  // namespace study
