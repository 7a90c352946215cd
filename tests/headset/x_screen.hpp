#pragma once
/// An X screen without a monitor, and an OpenGL context on it.

#include <string>

#include "tests/headset/openxr.hpp"

namespace simulated {

/// Runs Xvfb while the object lives. Its OpenGL context is current on the thread that made the object.
class XScreen {
 public:
  /// size: "640x480". std::runtime_error if there is no Xvfb, or no OpenGL 4.5 on it.
  explicit XScreen(const std::string& size = "64x48");
  ~XScreen();
  XScreen(const XScreen&) = delete;
  XScreen& operator=(const XScreen&) = delete;

  const XrGraphicsBindingOpenGLXlibKHR& binding() const { return binding_; }

  const std::string& name() const { return name_; }

 private:
  void start(const std::string& size);
  void make_context();

  int server_ = 0;
  std::string name_;
  XrGraphicsBindingOpenGLXlibKHR binding_{};
};

}  // namespace simulated
