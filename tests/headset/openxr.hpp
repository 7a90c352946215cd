#pragma once
/// The declarations of OpenXR from libstudy/headset/openxr.hpp, with those of the Xlib binding added.

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
