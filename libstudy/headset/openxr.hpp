#pragma once
/// OpenXR's declarations for OpenGL through EGL, with functions by pointer, because the loader is opened at
/// run time.

// epoxy first: it replaces the headers of EGL and GL.
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <time.h>

#define XR_NO_PROTOTYPES
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#define XR_USE_TIMESPEC
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>
