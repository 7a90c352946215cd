/// Does what a window manager does when a window is minimised or restored: sets the window's WM_STATE (ICCCM
/// 4.1.3.1). For virtual screens without a window manager. usage: set-minimised TITLE yes|no
#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include <cstdio>
#include <string>

namespace {

bool is_called(Display* display, Window window, const std::string& title) {
  char* name = nullptr;
  if (XFetchName(display, window, &name) == 0 || !name) return false;
  const bool same = title == name;
  XFree(name);
  return same;
}

/// The first of the screen's windows with this title; 0: none.
Window find_window(Display* display, const std::string& title) {
  Window root = 0, parent = 0, *children = nullptr, found = 0;
  unsigned count = 0;
  if (XQueryTree(display, DefaultRootWindow(display), &root, &parent, &children, &count) == 0) return 0;
  for (unsigned i = 0; i < count && found == 0; ++i) {
    if (is_called(display, children[i], title)) found = children[i];
  }
  if (children) XFree(children);
  return found;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string wish = argc == 3 ? argv[2] : "";
  Display* const display = XOpenDisplay(nullptr);
  const Window window = display && argc == 3 ? find_window(display, argv[1]) : 0;
  if (window == 0 || (wish != "yes" && wish != "no")) {
    std::fprintf(stderr, "set-minimised: needs TITLE yes|no, and a window with this title on $DISPLAY\n");
    return 1;
  }
  const Atom wm_state = XInternAtom(display, "WM_STATE", False);
  const long state[] = {wish == "yes" ? IconicState : NormalState,
                        None};  // 32-bit values are passed as longs
  XChangeProperty(display, window, wm_state, wm_state, 32, PropModeReplace,
                  reinterpret_cast<const unsigned char*>(state), 2);
  XCloseDisplay(display);
  return 0;
}
