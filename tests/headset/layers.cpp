/// Checks the layers of a frame against the specification.

#include <cstdio>

#include "tests/headset/parts.hpp"

namespace simulated {

namespace {

constexpr float right_angle = 1.57079632f;
const char* const eye_names[] = {"left", "right"};

std::string format(const char* how, auto... values) {
  char text[256];
  std::snprintf(text, sizeof text, how, values...);
  return text;
}

std::string words(const XrPosef& a) {
  const auto& [q, p] = a;
  const auto d = [](float x) { return static_cast<double>(x); };
  return format(" at %.6f %.6f %.6f turned %.6f %.6f %.6f %.6f", d(p.x), d(p.y), d(p.z), d(q.x), d(q.y),
                d(q.z), d(q.w));
}

void check_image(const XrSwapchainSubImage& part, std::string& text) {
  const Swapchain& swapchain = find(runtime().swapchains, part.swapchain, "swapchain");
  need(swapchain.shown >= 0, XR_ERROR_LAYER_INVALID, "a swapchain of which no image was released");
  if (!swapchain.acquired.empty()) note("an image is acquired and not released (allowed)");
  const auto& [offset, extent] = part.imageRect;
  const auto inside = [](std::int64_t from, std::int64_t length, std::uint32_t whole) {
    return from >= 0 && length > 0 && from + length <= whole;
  };
  need(inside(offset.x, extent.width, swapchain.info.width) &&
           inside(offset.y, extent.height, swapchain.info.height),
       XR_ERROR_SWAPCHAIN_RECT_INVALID, "a rectangle that leaves the image");
  need(part.imageArrayIndex < swapchain.info.arraySize, XR_ERROR_VALIDATION_FAILURE,
       "an index beyond the array of the image");
  text += format(" swapchain %llu image %ld slice %u rect %d %d %d %d",
                 static_cast<unsigned long long>(number_of(part.swapchain)), swapchain.shown,
                 part.imageArrayIndex, offset.x, offset.y, extent.width, extent.height);
}

void check_fov(const XrFovf& fov) {
  for (const float angle : {fov.angleLeft, fov.angleRight, fov.angleUp, fov.angleDown})
    need(std::fabs(angle) < right_angle, XR_ERROR_VALIDATION_FAILURE, "a field of view beyond 90 degrees");
  need(fov.angleLeft != fov.angleRight && fov.angleUp != fov.angleDown, XR_ERROR_VALIDATION_FAILURE,
       "a field of view that is empty");
  // OpenXR allows a flipped field of view, which mirrors the picture. A program that submits located views
  // never intends it, so it is logged as a breach.
  if (fov.angleLeft > fov.angleRight || fov.angleDown > fov.angleUp)
    breach("a field of view that is flipped");
}

bool near(float a, float b) { return std::fabs(a - b) < 1e-5f; }
bool same(const XrPosef& a, const XrPosef& b) {
  const auto &p = a.orientation, &q = b.orientation;
  const bool here = near(a.position.x, b.position.x) && near(a.position.y, b.position.y) &&
                    near(a.position.z, b.position.z);
  return here && near(std::fabs(p.x * q.x + p.y * q.y + p.z * q.z + p.w * q.w), 1);
}
bool same(const XrFovf& a, const XrFovf& b) {
  return near(a.angleLeft, b.angleLeft) && near(a.angleRight, b.angleRight) && near(a.angleUp, b.angleUp) &&
         near(a.angleDown, b.angleDown);
}

/// Refuses a view that has the pose or the field of view of the other eye and not its own. All stored calls
/// of xrLocateViews count, because a program may submit an old image again with the pose for which it was
/// drawn.
void check_eye(const Session& session, const XrCompositionLayerProjection& layer, std::size_t eye) {
  const XrCompositionLayerProjectionView& view = layer.views[eye];
  std::array<bool, 2> pose_of{}, fov_of{};
  for (const Located& one : session.located) {
    if (one.space != layer.space) continue;
    for (std::size_t i = 0; i < 2; ++i) {
      pose_of[i] = pose_of[i] || same(one.poses[i], view.pose);
      fov_of[i] = fov_of[i] || same(one.fovs[i], view.fov);
    }
  }
  need(pose_of[eye] || !pose_of[1 - eye], XR_ERROR_VALIDATION_FAILURE, "the eyes' poses are swapped");
  need(fov_of[eye] || !fov_of[1 - eye], XR_ERROR_VALIDATION_FAILURE, "the eyes' fields of view are swapped");
  if (!pose_of[eye]) note("a pose that was not located in the layer's space (allowed)");
  if (!fov_of[eye]) note("a field of view that was not located (allowed)");
}

void check_projection(const Session& session, const XrCompositionLayerProjection& layer,
                      std::vector<Shown>& images, std::string& text) {
  const std::uint32_t eyes = runtime().profile.stereo ? 2 : 1;
  need(layer.viewCount == eyes, XR_ERROR_VALIDATION_FAILURE, "another number of views than was located");
  text += " | projection space " + std::to_string(number_of(layer.space));
  for (std::uint32_t eye = 0; eye < eyes; ++eye) {
    const XrCompositionLayerProjectionView& view = layer.views[eye];
    need_type(&view, XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW);
    need_chain(view.next);
    text += std::string(" ") + eye_names[eye];
    check_image(view.subImage, text);
    need(is_valid(view.pose), XR_ERROR_POSE_INVALID, "a pose that is none");
    check_fov(view.fov);
    if (eyes == 2) check_eye(session, layer, eye);
    const auto d = [](float x) { return static_cast<double>(x); };
    text += words(view.pose) + format(" fov %.6f %.6f %.6f %.6f", d(view.fov.angleLeft),
                                      d(view.fov.angleRight), d(view.fov.angleUp), d(view.fov.angleDown));
    images.push_back({&view.subImage, eye_names[eye]});
  }
}

void check_quad(const XrCompositionLayerQuad& layer, std::vector<Shown>& images, std::string& text) {
  text += " | quad space " + std::to_string(number_of(layer.space));
  check_image(layer.subImage, text);
  need(is_valid(layer.pose), XR_ERROR_POSE_INVALID, "a pose that is none");
  need(layer.eyeVisibility <= XR_EYE_VISIBILITY_RIGHT, XR_ERROR_VALIDATION_FAILURE, "neither eye's quad");
  need(layer.size.width > 0 && layer.size.height > 0, XR_ERROR_VALIDATION_FAILURE, "a quad without a size");
  text += words(layer.pose) + format(" size %.6f %.6f", static_cast<double>(layer.size.width),
                                     static_cast<double>(layer.size.height));
  images.push_back({&layer.subImage, "quad"});
}

}  // namespace

std::vector<Shown> check_layers(const Session& session, const XrFrameEndInfo& info, std::string& text) {
  need(info.layerCount <= XR_MIN_COMPOSITION_LAYERS_SUPPORTED, XR_ERROR_LAYER_LIMIT_EXCEEDED,
       "more layers than the system takes");
  std::vector<Shown> images;
  std::vector<const XrCompositionLayerQuad*> quads;
  for (std::uint32_t i = 0; i < info.layerCount; ++i) {
    const XrCompositionLayerBaseHeader* layer = info.layers[i];
    need(layer, XR_ERROR_LAYER_INVALID, "a layer that is none");
    need_chain(layer->next);
    find(runtime().spaces, layer->space, "space");
    if (layer->type == XR_TYPE_COMPOSITION_LAYER_PROJECTION) {
      check_projection(session, *reinterpret_cast<const XrCompositionLayerProjection*>(layer), images, text);
    } else if (layer->type == XR_TYPE_COMPOSITION_LAYER_QUAD) {
      quads.push_back(reinterpret_cast<const XrCompositionLayerQuad*>(layer));
      check_quad(*quads.back(), images, text);
    } else {
      refuse(XR_ERROR_LAYER_INVALID, "a layer of a kind that is not offered");
    }
    images.back().name += i == 0 ? "" : std::to_string(i);
    if (layer->type == XR_TYPE_COMPOSITION_LAYER_PROJECTION && i > 0)
      images[images.size() - 2].name += std::to_string(i);
  }
  see_page(quads);
  return images;
}

}  // namespace simulated
