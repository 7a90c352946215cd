#include "libstudy/window/headset_mirror.hpp"

// epoxy must come before GLFW: GLFW then does not include OpenGL's headers.
#include <epoxy/gl.h>

#include <GLFW/glfw3.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "libstudy/headset/mirror_picture.hpp"
#include "libstudy/stimulus/framing.hpp"
#include "libstudy/window/glfw_window.hpp"

namespace study {

namespace {

constexpr std::chrono::milliseconds between_pictures{100};
/// The mirror draws for at most 1 / most_share of the time: software OpenGL takes CPU cores from the session.
constexpr int most_share = 4;

WindowChoice choice_of(bool reveal) {
  WindowChoice choice;
  choice.title = reveal ? "vip: what is seen in the headset (logged)" : "vip: pages in the headset";
  choice.width_px = choice.height_px = MirrorPicture::side_px;
  choice.mend = "leave --mirror out on a machine without a screen";
  choice.in_background = true;
  return choice;
}

/// Draws the mirror's pictures in the context that shares the headset's pictures. Makes this context current
/// only while it draws: a thread has one current context, and the window needs its own, perhaps of another
/// kind (GLX, EGL).
class PictureTaker {
 public:
  explicit PictureTaker(sim::GlContext& gl) : gl_(gl) {
    gl_.make_current();
    picture_ = std::make_unique<MirrorPicture>();
    gl_.release();
  }
  ~PictureTaker() {
    gl_.make_current();
    picture_.reset();
    gl_.release();
  }
  PictureTaker(const PictureTaker&) = delete;
  PictureTaker& operator=(const PictureTaker&) = delete;

  /// Returns the picture; none if all of it is black.
  std::optional<sim::Image> take(HeadsetDisplay& display, bool reveal) {
    gl_.make_current();
    std::optional<sim::Image> image;
    if (picture_->draw(display.look(), reveal)) image = picture_->read();
    display.look_away();
    gl_.release();
    return image;
  }

 private:
  sim::GlContext& gl_;
  std::unique_ptr<MirrorPicture> picture_;
};

/// The mirror's window. Its OpenGL context is current only during the constructor and during show().
class PictureWindow {
 public:
  explicit PictureWindow(bool reveal) : window_(choice_of(reveal)) {
    glfwSwapInterval(0);
    const Current current(window_);
    sim::require_gl45();
    glCreateTextures(GL_TEXTURE_2D, 1, &texture_);
    glTextureStorage2D(texture_, 1, GL_RGBA8, MirrorPicture::side_px, MirrorPicture::side_px);
    glCreateFramebuffers(1, &source_);
    glNamedFramebufferTexture(source_, GL_COLOR_ATTACHMENT0, texture_, 0);
  }
  /// The window's context destroys the OpenGL objects.
  ~PictureWindow() = default;
  PictureWindow(const PictureWindow&) = delete;
  PictureWindow& operator=(const PictureWindow&) = delete;

  /// Shows the image; none: black. Returns false once the window was closed or its screen is gone.
  bool show(const std::optional<sim::Image>& image) {
    glfwPollEvents();
    if (GlfwWindow::display_is_gone() || window_.asked_to_close()) return false;
    const auto [width, height] = window_.size();
    if (width < 1 || height < 1) return true;  // minimised
    const Current current(window_);
    constexpr std::array<float, 4> black{0, 0, 0, 1};
    glClearNamedFramebufferfv(0, GL_COLOR, 0, black.data());
    if (image) put(*image, fit_picture(image->width, image->height, width, height));
    glfwSwapBuffers(window_.get());
    return true;
  }

 private:
  void put(const sim::Image& image, const Rectangle& to) const {
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(texture_, 0, 0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE,
                        image.rgba.data());
    // Flips the picture, because an image begins with its top row.
    glBlitNamedFramebuffer(source_, 0, 0, image.height, image.width, 0, to.x0, to.y0, to.x1, to.y1,
                           GL_COLOR_BUFFER_BIT, GL_LINEAR);
  }

  struct Current {
    explicit Current(const GlfwWindow& window) { glfwMakeContextCurrent(window.get()); }
    ~Current() { glfwMakeContextCurrent(nullptr); }
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;
  };

  GlfwWindow window_;
  unsigned texture_ = 0, source_ = 0;
};

}  // namespace

HeadsetMirror::HeadsetMirror(HeadsetDisplay& display, bool reveal)
    : display_(display), reveal_(reveal), pictures_(display.admit_onlooker()) {
  std::promise<void> opened;
  std::future<void> open = opened.get_future();
  thread_ = std::thread([this, told = std::move(opened)]() mutable { run(std::move(told)); });
  try {
    open.get();
  } catch (...) {
    thread_.join();
    throw;
  }
}

HeadsetMirror::~HeadsetMirror() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

/// Waits for `time`. Returns false, at once, when the thread must end.
bool HeadsetMirror::wait(std::chrono::steady_clock::duration time) {
  std::unique_lock lock(mutex_);
  return !changed_.wait_for(lock, time, [this] { return over_; });
}

/// Body of the mirror's thread, which makes all GLFW calls: X11 does not require that the main thread makes
/// them.
void HeadsetMirror::run(std::promise<void> opened) {
  std::unique_ptr<PictureWindow> window;
  std::unique_ptr<PictureTaker> taker;
  try {
    taker = std::make_unique<PictureTaker>(pictures_);
    window = std::make_unique<PictureWindow>(reveal_);
  } catch (...) {
    opened.set_exception(std::current_exception());
    return;
  }
  opened.set_value();
  // Closing the window stops the mirror only; the session goes on.
  for (bool goes_on = true; goes_on;) {
    const auto begun = std::chrono::steady_clock::now();
    goes_on = window->show(taker->take(display_, reveal_));
    const auto taken = std::chrono::steady_clock::now() - begun;
    goes_on = goes_on && wait(std::max<decltype(taken)>(between_pictures, (most_share - 1) * taken));
  }
}

}  // namespace study
