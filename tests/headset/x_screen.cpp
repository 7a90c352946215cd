#include "tests/headset/x_screen.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <stdexcept>

namespace simulated {

XScreen::XScreen(const std::string& size) {
  start(size);
  make_context();
}

XScreen::~XScreen() {
  if (binding_.xDisplay) {
    glXMakeCurrent(binding_.xDisplay, 0, nullptr);
    glXDestroyContext(binding_.xDisplay, binding_.glxContext);
    XCloseDisplay(binding_.xDisplay);
  }
  ::kill(server_, SIGTERM);
  ::waitpid(server_, nullptr, 0);
}

void XScreen::start(const std::string& size) {
  const std::string mode = size + "x24";
  int told[2];
  if (::pipe2(told, O_CLOEXEC) != 0) throw std::runtime_error("no pipe to Xvfb; raise ulimit -n");
  server_ = ::fork();
  if (server_ == 0) {
    ::dup2(::open("/dev/null", O_WRONLY), STDERR_FILENO);
    ::dup2(told[1], 3);
    ::execlp("Xvfb", "Xvfb", "-displayfd", "3", "-noreset", "-screen", "0", mode.c_str(), nullptr);
    ::_exit(126);
  }
  ::close(told[1]);
  std::FILE* in = ::fdopen(told[0], "r");
  int number = 0;
  const bool tells = std::fscanf(in, "%d", &number) == 1;
  std::fclose(in);
  if (!tells) throw std::runtime_error("Xvfb does not start; install xvfb");
  name_ = ":" + std::to_string(number);
}

void XScreen::make_context() {
  Display* display = XOpenDisplay(name_.c_str());
  if (!display)
    throw std::runtime_error("Xvfb: its display " + name_ + " cannot be opened; run the test again");
  binding_.type = XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR;
  binding_.xDisplay = display;
  const int wanted[] = {GLX_DRAWABLE_TYPE, GLX_PBUFFER_BIT | GLX_WINDOW_BIT, GLX_RENDER_TYPE, GLX_RGBA_BIT,
                        0};
  int count = 0;
  GLXFBConfig* configs = glXChooseFBConfig(display, DefaultScreen(display), wanted, &count);
  if (!configs || count == 0)
    throw std::runtime_error("Xvfb: no GLX configuration with pbuffers; install libgl1-mesa-dri");
  binding_.glxFBConfig = configs[0];
  XFree(configs);
  int visual = 0;
  glXGetFBConfigAttrib(display, binding_.glxFBConfig, GLX_VISUAL_ID, &visual);
  binding_.visualid = static_cast<std::uint32_t>(visual);
  const int size[] = {GLX_PBUFFER_WIDTH, 64, GLX_PBUFFER_HEIGHT, 48, 0};
  binding_.glxDrawable = glXCreatePbuffer(display, binding_.glxFBConfig, size);
  const int version[] = {GLX_CONTEXT_MAJOR_VERSION_ARB, 4, GLX_CONTEXT_MINOR_VERSION_ARB, 5, 0};
  binding_.glxContext = glXCreateContextAttribsARB(display, binding_.glxFBConfig, nullptr, 1, version);
  if (!binding_.glxContext || !glXMakeCurrent(display, binding_.glxDrawable, binding_.glxContext))
    throw std::runtime_error("Xvfb: no OpenGL 4.5; install libgl1-mesa-dri");
}

}  // namespace simulated
