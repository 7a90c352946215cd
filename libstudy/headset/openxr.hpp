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
