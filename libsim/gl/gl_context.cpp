// epoxy must come first: it replaces the headers of EGL and GL.
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <dlfcn.h>

#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

#include "libsim/gl/gl_context_state.hpp"
#include "stats/base/error.hpp"

namespace sim {

namespace {

constexpr const char* mend =
    "install libegl1 and libgl1-mesa-dri (software OpenGL), or a GPU driver with OpenGL 4.5";

bool has_word(const char* list, std::string_view word) {
  if (!list) return false;
  std::string_view rest(list);
  while (!rest.empty()) {
    const auto end = rest.find(' ');
    if (rest.substr(0, end) == word) return true;
    if (end == std::string_view::npos) break;
    rest.remove_prefix(end + 1);
  }
  return false;
}

struct Trial {
  std::string name;
  EGLenum platform;
  void* native;
};

/// base::Error if a library is missing. Without this check epoxy would abort the program.
void require_libraries() {
  for (const char* library : {"libEGL.so.1", "libGL.so.1"}) {
    void* handle = dlopen(library, RTLD_LAZY | RTLD_LOCAL);
    if (!handle && std::strcmp(library, "libGL.so.1") == 0)
      handle = dlopen("libOpenGL.so.0", RTLD_LAZY | RTLD_LOCAL);
    if (!handle) throw base::Error("OpenGL", std::string("no ") + library + " on this machine", mend);
  }
}

std::vector<Trial> list_trials(const char* client_extensions) {
  std::vector<Trial> hardware, software;
  if (has_word(client_extensions, "EGL_EXT_platform_device") &&
      (has_word(client_extensions, "EGL_EXT_device_enumeration") ||
       has_word(client_extensions, "EGL_EXT_device_base"))) {
    EGLint count = 0;
    eglQueryDevicesEXT(0, nullptr, &count);
    std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
    if (count > 0) eglQueryDevicesEXT(count, devices.data(), &count);
    for (std::size_t i = 0; i < devices.size(); ++i) {
      const char* extensions = eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS);
      const bool is_software = has_word(extensions, "EGL_MESA_device_software");
      (is_software ? software : hardware)
          .push_back({"EGL device " + std::to_string(i), EGL_PLATFORM_DEVICE_EXT, devices[i]});
    }
  }
  std::vector<Trial> trials = std::move(hardware);
  if (has_word(client_extensions, "EGL_MESA_platform_surfaceless")) {
    trials.push_back({"EGL surfaceless", EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY});
  }
  trials.insert(trials.end(), software.begin(), software.end());
  return trials;
}

struct EglState final : public GlContext::State {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLConfig config = nullptr;
  EGLContext context = EGL_NO_CONTEXT;

  ~EglState() override {
    if (context != EGL_NO_CONTEXT) {
      if (eglGetCurrentContext() == context) {
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      }
      eglDestroyContext(display, context);
    }
    // eglTerminate() is not called, because all EGL contexts of the process share the display.
  }

  void create(EGLContext shared) {
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_NONE};
    context = eglCreateContext(display, config, shared, attributes);
  }

  /// Returns an empty string on success, otherwise the problem.
  std::string open(const Trial& trial) {
    display = eglGetPlatformDisplayEXT(trial.platform, trial.native, nullptr);
    if (display == EGL_NO_DISPLAY) return "no display";
    EGLint major = 0, minor = 0;
    if (!eglInitialize(display, &major, &minor)) return "eglInitialize failed";
    if (!has_word(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context")) {
      return "no EGL_KHR_surfaceless_context";
    }
    if (!eglBindAPI(EGL_OPENGL_API)) return "no desktop OpenGL";
    const EGLint config_attributes[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLint configs = 0;
    if (!eglChooseConfig(display, config_attributes, &config, 1, &configs) || configs == 0) {
      return "no configuration with OpenGL";
    }
    create(EGL_NO_CONTEXT);
    if (context == EGL_NO_CONTEXT) return "no OpenGL 4.5 core context";
    if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) return "eglMakeCurrent failed";
    return "";
  }

  bool make_current() override {
    eglBindAPI(EGL_OPENGL_API);  // EGL stores the bound API per thread
    return eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
  }
  void release() override { eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }
  std::unique_ptr<State> make_shared() const override {
    auto out = std::make_unique<EglState>();
    out->display = display;
    out->config = config;
    out->create(context);
    if (out->context == EGL_NO_CONTEXT) return nullptr;
    return out;
  }
  EglHandles egl() const override { return {display, config, context}; }
};

}  // namespace

GlContext::GlContext(std::unique_ptr<State> state) : state_(std::move(state)) {}
GlContext::GlContext(GlContext&&) noexcept = default;
GlContext& GlContext::operator=(GlContext&&) noexcept = default;
GlContext::~GlContext() = default;

GlContext GlContext::make_headless() {
  require_libraries();
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (!has_word(extensions, "EGL_EXT_platform_base")) {
    throw base::Error("OpenGL", "this EGL cannot choose a platform (no EGL_EXT_platform_base)", mend);
  }
  std::string told;
  for (const Trial& trial : list_trials(extensions)) {
    auto state = std::make_unique<EglState>();
    const std::string problem = state->open(trial);
    if (problem.empty()) {
      require_gl45();
      return GlContext(std::move(state));
    }
    told += (told.empty() ? "" : "; ") + trial.name + ": " + problem;
  }
  throw base::Error("OpenGL", "no headless OpenGL 4.5 context" + (told.empty() ? "" : " (" + told + ")"),
                    mend);
}

GlContext GlContext::make_shared() const {
  std::unique_ptr<State> state = state_->make_shared();
  if (!state) throw base::Error("OpenGL", "the driver gives no second context", "update the graphics driver");
  return GlContext(std::move(state));
}

void GlContext::make_current() {
  if (state_->make_current()) return;
  throw base::Error("OpenGL", "the headless context cannot be made current",
                    "release the context on the other thread first");
}

void GlContext::release() { state_->release(); }
EglHandles GlContext::egl() const { return state_->egl(); }
GlxHandles GlContext::glx() const { return state_->glx(); }

namespace {
std::string gl_string(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text ? text : "unknown";
}
}  // namespace

std::string gl_description() { return gl_string(GL_RENDERER) + ", OpenGL " + gl_string(GL_VERSION); }

bool gl_is_software() {
  const std::string renderer = gl_string(GL_RENDERER);
  for (const char* name : {"llvmpipe", "softpipe", "SWR", "Software Rasterizer"}) {
    if (renderer.find(name) != std::string::npos) return true;
  }
  return false;
}

void require_gl45() {
  const int version = epoxy_gl_version();
  if (version < 45) {
    throw base::Error("OpenGL",
                      "the context has version " + std::to_string(version / 10) + "." +
                          std::to_string(version % 10) + ", 4.5 is needed",
                      mend);
  }
}

}  // namespace sim
