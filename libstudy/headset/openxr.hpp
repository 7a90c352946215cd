#pragma once
/// OpenXR's declarations for OpenGL through EGL. Functions are declared as pointer types only, because the
/// loader is opened at run time.

// epoxy must come first: it replaces the headers of EGL and OpenGL.
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <time.h>

#define XR_NO_PROTOTYPES
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#define XR_USE_TIMESPEC
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#ifndef XR_EXT_user_presence
/// Declarations of the extension XR_EXT_user_presence, which headers before OpenXR 1.1 lack.
#define XR_EXT_USER_PRESENCE_EXTENSION_NAME "XR_EXT_user_presence"
constexpr auto XR_TYPE_EVENT_DATA_USER_PRESENCE_CHANGED_EXT = static_cast<XrStructureType>(1'000'470'000);
constexpr auto XR_TYPE_SYSTEM_USER_PRESENCE_PROPERTIES_EXT = static_cast<XrStructureType>(1'000'470'001);
struct XrEventDataUserPresenceChangedEXT {
  XrStructureType type;
  const void* next;
  XrSession session;
  XrBool32 isUserPresent;
};
struct XrSystemUserPresencePropertiesEXT {
  XrStructureType type;
  void* next;
  XrBool32 supportsUserPresence;
};
#endif
