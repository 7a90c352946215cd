/// Swapchains: textures of the session's context, acquired and released in the specification's order.

#include "tests/headset/gl.hpp"
#include "tests/headset/parts.hpp"

namespace simulated {

namespace {

constexpr int images_of_each = 3;

Swapchain& need_swapchain(XrSwapchain swapchain) {
  Swapchain& found = find(runtime().swapchains, swapchain, "swapchain");
  need_session(as_handle<XrSession>(found.session));
  return found;
}
const Graphics& graphics_of(const Swapchain& swapchain) {
  return runtime().sessions.at(swapchain.session).graphics;
}
XrResult success(const Swapchain& swapchain) { return success(runtime().sessions.at(swapchain.session)); }

XrResult enumerate_formats(XrSession session, std::uint32_t capacity, std::uint32_t* count,
                           std::int64_t* out) {
  const Session& found = need_session(session);
  const XrResult result = give_values(runtime().profile.formats, capacity, count, out);
  return result == XR_SUCCESS ? success(found) : result;
}

void need_possible(const XrSwapchainCreateInfo& info) {
  const Profile& profile = runtime().profile;
  const auto& formats = profile.formats;
  need(std::find(formats.begin(), formats.end(), info.format) != formats.end(),
       XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED, "a format that is not listed");
  if (info.format == profile.broken_format) fail(XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED);
  need(info.width > 0 && info.height > 0 && info.arraySize > 0 && info.mipCount > 0,
       XR_ERROR_VALIDATION_FAILURE, "images without pixels");
  need(info.width <= 8192 && info.height <= 8192, XR_ERROR_VALIDATION_FAILURE,
       "images larger than the system's largest");
  need(info.faceCount == 1 || info.faceCount == 6, XR_ERROR_VALIDATION_FAILURE, "neither 1 nor 6 faces");
  need(info.sampleCount > 0, XR_ERROR_VALIDATION_FAILURE, "images without samples");
  if (info.sampleCount > 1 || info.faceCount > 1 || info.createFlags != 0) fail(XR_ERROR_FEATURE_UNSUPPORTED);
}

GLuint make_texture(const XrSwapchainCreateInfo& info) {
  const bool array = info.arraySize > 1;
  const auto size = [](std::uint32_t n) { return static_cast<GLsizei>(n); };
  const auto format = static_cast<GLenum>(info.format);
  GLuint texture = 0;
  glCreateTextures(array ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D, 1, &texture);
  if (array) {
    glTextureStorage3D(texture, size(info.mipCount), format, size(info.width), size(info.height),
                       size(info.arraySize));
  } else {
    glTextureStorage2D(texture, size(info.mipCount), format, size(info.width), size(info.height));
  }
  return texture;
}

XrResult create_swapchain(XrSession session, const XrSwapchainCreateInfo* info, XrSwapchain* swapchain) {
  const Session& found = need_session(session);
  need_type(info, XR_TYPE_SWAPCHAIN_CREATE_INFO);
  need_chain(info->next);
  need_possible(*info);
  const SessionContext taken(found.graphics);
  Swapchain fresh;
  fresh.session = number_of(session);
  fresh.info = *info;
  for (int i = 0; i < images_of_each; ++i) fresh.images.push_back(make_texture(*info));
  *swapchain = new_handle<XrSwapchain>(runtime().swapchains, fresh);
  return success(found);
}

XrResult destroy_swapchain(XrSwapchain swapchain) {
  Runtime& all = runtime();
  Swapchain& found = find(all.swapchains, swapchain, "swapchain");
  const SessionContext taken(graphics_of(found));
  glDeleteTextures(images_of_each, found.images.data());
  all.swapchains.erase(number_of(swapchain));
  return XR_SUCCESS;
}

XrResult enumerate_images(XrSwapchain swapchain, std::uint32_t capacity, std::uint32_t* count,
                          XrSwapchainImageBaseHeader* out) {
  const Swapchain& found = need_swapchain(swapchain);
  const SessionContext taken(graphics_of(found));
  auto* images = reinterpret_cast<XrSwapchainImageOpenGLKHR*>(out);
  const XrResult result = give_array(found.images, capacity, count, [&](std::size_t i, GLuint image) {
    need_type(&images[i], XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR);
    images[i].image = image;
  });
  return result == XR_SUCCESS ? success(found) : result;
}

XrResult acquire_image(XrSwapchain swapchain, const XrSwapchainImageAcquireInfo* info, std::uint32_t* index) {
  Swapchain& found = need_swapchain(swapchain);
  const SessionContext taken(graphics_of(found));
  need_type_or_null(info, XR_TYPE_SWAPCHAIN_IMAGE_ACQUIRE_INFO);
  need(found.acquired.size() < images_of_each, XR_ERROR_CALL_ORDER_INVALID,
       "every image is acquired and none released");
  *index = found.next;
  found.next = (found.next + 1) % images_of_each;
  found.acquired.push_back(*index);
  return success(found);
}

XrResult wait_image(XrSwapchain swapchain, const XrSwapchainImageWaitInfo* info) {
  Swapchain& found = need_swapchain(swapchain);
  const SessionContext taken(graphics_of(found));
  need_type(info, XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO);
  need(!found.acquired.empty(), XR_ERROR_CALL_ORDER_INVALID, "no image is acquired");
  need(!found.waited, XR_ERROR_CALL_ORDER_INVALID, "the image before was waited for and not released");
  if (double& left = runtime().knobs.at("image_timeouts"); left > 0) {
    left -= 1;
    return XR_TIMEOUT_EXPIRED;
  }
  found.waited = true;
  return success(found);
}

XrResult release_image(XrSwapchain swapchain, const XrSwapchainImageReleaseInfo* info) {
  Swapchain& found = need_swapchain(swapchain);
  const SessionContext taken(graphics_of(found));
  need_type_or_null(info, XR_TYPE_SWAPCHAIN_IMAGE_RELEASE_INFO);
  need(found.waited, XR_ERROR_CALL_ORDER_INVALID, "no image was waited for");
  found.shown = found.acquired.front();
  found.acquired.pop_front();
  found.waited = false;
  return success(found);
}

}  // namespace

void add_swapchain_functions(Functions& functions) {
  add<"xrEnumerateSwapchainFormats", enumerate_formats>(functions);
  add<"xrCreateSwapchain", create_swapchain>(functions);
  add<"xrDestroySwapchain", destroy_swapchain>(functions);
  add<"xrEnumerateSwapchainImages", enumerate_images>(functions);
  add<"xrAcquireSwapchainImage", acquire_image, Logged::frame_line>(functions);
  add<"xrWaitSwapchainImage", wait_image, Logged::frame_line>(functions);
  add<"xrReleaseSwapchainImage", release_image, Logged::frame_line>(functions);
}

}  // namespace simulated
