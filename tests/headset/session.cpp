/// Sessions: their graphics binding, begin and end.

#include "tests/headset/gl.hpp"
#include "tests/headset/parts.hpp"

namespace simulated {

namespace {

Graphics read_egl(const XrGraphicsBindingEGLMNDX& binding) {
  need(binding.getProcAddress && binding.display && binding.context, XR_ERROR_GRAPHICS_DEVICE_INVALID,
       "a binding without display, context or functions");
  Graphics out;
  out.egl_display = binding.display;
  out.egl_config = binding.config;
  out.egl_context = binding.context;
  return out;
}

Graphics read_xlib(const XrGraphicsBindingOpenGLXlibKHR& binding) {
  need(binding.xDisplay && binding.glxContext, XR_ERROR_GRAPHICS_DEVICE_INVALID,
       "a binding without display or context");
  need(binding.visualid != 0, XR_ERROR_GRAPHICS_DEVICE_INVALID, "a binding without a visual");
  Graphics out;
  out.x_display = binding.xDisplay;
  out.drawable = binding.glxDrawable;
  out.glx_context = binding.glxContext;
  return out;
}

Graphics read_binding(const void* next) {
  need_chain(next);
  if (const auto* egl = find_chained<const XrGraphicsBindingEGLMNDX>(next, XR_TYPE_GRAPHICS_BINDING_EGL_MNDX))
    return read_egl(*egl);
  if (const auto* xlib =
          find_chained<const XrGraphicsBindingOpenGLXlibKHR>(next, XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR))
    return read_xlib(*xlib);
  refuse(XR_ERROR_GRAPHICS_DEVICE_INVALID, "no graphics binding of an enabled extension");
}

XrResult create_session(XrInstance instance, const XrSessionCreateInfo* info, XrSession* session) {
  need_instance(instance);
  need_type(info, XR_TYPE_SESSION_CREATE_INFO);
  need_system(instance, info->systemId);
  Runtime& all = runtime();
  need(all.asked_graphics, XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING,
       "the graphics requirements were not asked for");
  Session fresh;
  fresh.graphics = read_binding(info->next);
  need(all.sessions.empty(), XR_ERROR_LIMIT_REACHED, "there is a session already");
  make_other_context(fresh.graphics);
  const SessionContext taken(fresh.graphics);
  *session = new_handle<XrSession>(all.sessions, fresh);
  enter(*session, XR_SESSION_STATE_IDLE);
  offer_ready();
  return XR_SUCCESS;
}

XrResult destroy_session(XrSession session) {
  {
    const SessionContext taken(find(runtime().sessions, session, "session").graphics);
    for (auto& [number, swapchain] : runtime().swapchains)
      glDeleteTextures(static_cast<GLsizei>(swapchain.images.size()), swapchain.images.data());
  }
  end_session_objects(number_of(session));
  return XR_SUCCESS;
}

XrResult begin_session(XrSession session, const XrSessionBeginInfo* info) {
  Session& found = need_session(session);
  need_type(info, XR_TYPE_SESSION_BEGIN_INFO);
  need(!found.running, XR_ERROR_SESSION_RUNNING, "the session runs already");
  need(found.state == XR_SESSION_STATE_READY, XR_ERROR_SESSION_NOT_READY, "the session is not ready");
  need_views(info->primaryViewConfigurationType);
  found.running = true;
  found.frames = 0;
  found.waited = found.begun = false;
  runtime().clock.last_end = 0;
  return success(found);
}

XrResult end_session(XrSession session) {
  Session& found = need_session(session);
  need(found.running, XR_ERROR_SESSION_NOT_RUNNING, "the session does not run");
  need(found.state == XR_SESSION_STATE_STOPPING, XR_ERROR_SESSION_NOT_STOPPING,
       "the session is not stopping");
  found.running = false;
  frame_begun().notify_all();
  enter(session, XR_SESSION_STATE_IDLE);
  if (found.exiting) enter(session, XR_SESSION_STATE_EXITING);
  offer_ready();
  return success(found);
}

XrResult request_exit(XrSession session) {
  Session& found = need_session(session);
  need(found.running, XR_ERROR_SESSION_NOT_RUNNING, "the session does not run");
  found.exiting = true;
  runtime().aim = XR_SESSION_STATE_STOPPING;
  step_state(session);
  return success(found);
}

}  // namespace

void end_session_objects(std::uint64_t session) {
  Runtime& all = runtime();
  destroy_other_context(all.sessions.at(session).graphics);
  for (auto& [number, set] : all.action_sets) set.attached = false;
  all.page.reset();
  const auto is_its = [&](const auto& object) { return object.second.session == session; };
  std::erase_if(all.swapchains, is_its);
  std::erase_if(all.spaces, is_its);
  all.sessions.erase(session);
  all.aim = XR_SESSION_STATE_FOCUSED;
  frame_begun().notify_all();
}

void add_session_functions(Functions& functions) {
  add<"xrCreateSession", create_session>(functions);
  add<"xrDestroySession", destroy_session>(functions);
  add<"xrBeginSession", begin_session>(functions);
  add<"xrEndSession", end_session>(functions);
  add<"xrRequestExitSession", request_exit>(functions);
}

}  // namespace simulated
