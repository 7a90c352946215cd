#pragma once
/// OpenXR's declarations as the project uses them, and those of the Xlib binding.

// epoxy first: it replaces the headers of EGL, GL and GLX.
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <epoxy/glx.h>

#define XR_USE_PLATFORM_XLIB
#include "libstudy/headset/openxr.hpp"
#undef Always
#undef Bool
#undef None
#undef Status
#undef Success
