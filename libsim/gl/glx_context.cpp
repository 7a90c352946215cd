// epoxy must come first: it replaces the headers of GL.
#include <epoxy/gl.h>
#include <epoxy/glx.h>

#include <dlfcn.h>

#include <atomic>
#include <cstdlib>
#include <mutex>
#include <string>
#include <utility>

#include "libsim/gl/gl_context_state.hpp"
#include "stats/base/error.hpp"

namespace sim {

namespace {

/// libX11, loaded at run time, so that programs without a GLX context do not need the library.
struct XLibrary {
  Display* (*open)(const char*) = nullptr;
  int (*close)(Display*) = nullptr;
  int (*free)(void*) = nullptr;
  Status (*init_threads)() = nullptr;
  XErrorHandler (*set_error_handler)(XErrorHandler) = nullptr;
  int (*sync)(Display*, Bool) = nullptr;

  static const XLibrary& get() {
    static const XLibrary library;
    return library;
  }

 private:
  XLibrary() {
    void* handle = dlopen("libX11.so.6", RTLD_LAZY | RTLD_LOCAL);
    void* gl = dlopen("libGL.so.1", RTLD_LAZY | RTLD_LOCAL);  // epoxy aborts the program if libGL is missing
    if (!handle || !gl)
      throw base::Error("OpenGL", "no libX11.so.6 or libGL.so.1 on this machine",
                        "install libx11-6 and libgl1");
    find(handle, "XOpenDisplay", open);
    find(handle, "XCloseDisplay", close);
    find(handle, "XFree", free);
    find(handle, "XInitThreads", init_threads);
    find(handle, "XSetErrorHandler", set_error_handler);
    find(handle, "XSync", sync);
    init_threads();
  }
  template <class F>
  static void find(void* handle, const char* name, F& out) {
    out = reinterpret_cast<F>(dlsym(handle, name));
    if (!out)
      throw base::Error("OpenGL", std::string("libX11.so.6 has no ") + name, "install libx11-6 again");
  }
};

/// Catches and records the X errors of one connection during the lifetime of this object. Xlib's default
/// handler would end the program, and a driver without OpenGL 4.5 causes such an error.
class XErrors {
 public:
  explicit XErrors(Display* display) : lock_(mutex_) {
    watched_ = display;
    found_ = false;
    before_ = XLibrary::get().set_error_handler([](Display* from, XErrorEvent* event) {
      if (from != watched_) return before_ ? before_.load()(from, event) : 0;
      found_ = true;
      return 0;
    });
  }
  ~XErrors() {
    XLibrary::get().sync(watched_, False);
    XLibrary::get().set_error_handler(before_);
  }
  XErrors(const XErrors&) = delete;
  XErrors& operator=(const XErrors&) = delete;

  /// True if an error occurred; waits, because errors arrive after their requests.
  bool any() const {
    XLibrary::get().sync(watched_, False);
    return found_;
  }

 private:
  // Static, because a process has only one handler of X errors.
  static inline std::mutex mutex_;
  static inline std::atomic<Display*> watched_;
  static inline std::atomic<bool> found_;
  static inline std::atomic<XErrorHandler> before_;

  std::lock_guard<std::mutex> lock_;
};

/// Connects to the X display that $DISPLAY names. The connection closes with its last owner.
std::shared_ptr<Display> open_display() {
  const XLibrary& x = XLibrary::get();
  Display* display = x.open(nullptr);
  if (!display) {
    const char* name = std::getenv("DISPLAY");
    throw base::Error("OpenGL",
                      std::string("no X display") + (name && *name ? std::string(" at ") + name : ""),
                      "start the program on a desktop, or set DISPLAY to an X display that runs");
  }
  return {display, [&x](Display* one) { x.close(one); }};
}

struct GlxState final : public GlContext::State {
  std::shared_ptr<Display> display;
  GLXFBConfig config = nullptr;
  GLXPbuffer drawable = 0;
  GLXContext context = nullptr;

  ~GlxState() override {
    if (context && glXGetCurrentContext() == context) release();
    if (context) glXDestroyContext(display.get(), context);
    if (drawable) glXDestroyPbuffer(display.get(), drawable);
  }
  bool make_current() override { return glXMakeCurrent(display.get(), drawable, context); }
  void release() override { glXMakeCurrent(display.get(), 0, nullptr); }
  std::unique_ptr<State> make_shared() const override {
    auto out = std::make_unique<GlxState>();
    out->display = display;
    out->config = config;
    if (!out->create(context)) return nullptr;
    return out;
  }
  GlxHandles glx() const override {
    int visual = 0;
    glXGetFBConfigAttrib(display.get(), config, GLX_VISUAL_ID, &visual);
    return {display.get(), config, drawable, context, static_cast<unsigned>(visual)};
  }

  void choose_config() {
    // Windows too, because OpenXR runtimes need a visual, which a configuration for pbuffers alone may lack.
    const int wanted[] = {GLX_DRAWABLE_TYPE,
                          GLX_PBUFFER_BIT | GLX_WINDOW_BIT,
                          GLX_RENDER_TYPE,
                          GLX_RGBA_BIT,
                          GLX_X_RENDERABLE,
                          True,
                          0};
    int count = 0;
    const int screen = DefaultScreen(display.get());
    GLXFBConfig* all = glXChooseFBConfig(display.get(), screen, wanted, &count);
    if (all && count > 0) config = all[0];
    if (all) XLibrary::get().free(all);
  }
  /// Creates an invisible surface of one pixel and a context on it. False if the driver refuses.
  bool create(GLXContext shared) {
    const XErrors errors(display.get());
    const int size[] = {GLX_PBUFFER_WIDTH, 1, GLX_PBUFFER_HEIGHT, 1, 0};
    drawable = glXCreatePbuffer(display.get(), config, size);
    const int attributes[] = {
        GLX_CONTEXT_MAJOR_VERSION_ARB,    4, GLX_CONTEXT_MINOR_VERSION_ARB, 5, GLX_CONTEXT_PROFILE_MASK_ARB,
        GLX_CONTEXT_CORE_PROFILE_BIT_ARB, 0};
    context = glXCreateContextAttribsARB(display.get(), config, shared, True, attributes);
    if (context && !errors.any()) return true;
    if (context) glXDestroyContext(display.get(), context);
    context = nullptr;
    drawable = 0;  // not destroyed, because it may not exist; closing the connection frees it
    return false;
  }
};

}  // namespace

GlContext GlContext::make_on_x() {
  auto state = std::make_unique<GlxState>();
  state->display = open_display();
  state->choose_config();
  if (!state->config || !state->create(nullptr) || !state->make_current())
    throw base::Error("OpenGL", "no OpenGL 4.5 core context on the X display", "update the graphics driver");
  require_gl45();
  return GlContext(std::move(state));
}

}  // namespace sim
