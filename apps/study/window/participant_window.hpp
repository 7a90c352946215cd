#pragma once
/// The window in front of a participant: pages, pauses and the question whether to stop. One a session.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/window/glfw_window.hpp"
#include "apps/study/desk/page.hpp"
#include "apps/study/desk/words.hpp"
#include "apps/study/window/gamepad.hpp"
#include "apps/study/window/gui.hpp"
#include "apps/study/window/mirror_window.hpp"
#include "apps/study/window/page_view.hpp"
#include "libstudy/session/session.hpp"

namespace apps {

struct ParticipantWindowOptions {
  int width_px = 0, height_px = 0;  ///< 0: the whole monitor
  int monitor = 0;
  std::string language = "en";
};

/// All calls on the thread that made it, with a clock that runs by itself.
class ParticipantWindow {
 public:
  /// base::Error when there is no display or no OpenGL 4.5 on it.
  explicit ParticipantWindow(const ParticipantWindowOptions& options);

  /// Shows a page until it is confirmed. Esc asks whether to stop; what then follows comes through wish().
  std::vector<study::TimedAnswer> run_page(PageText text, std::span<const study::Question> questions,
                                           double least_s, const study::Clock& clock,
                                           const study::Check& check);
  /// Asks for one of two; true: the first.
  bool choose_first(const DeskChoice& choice, const study::Clock& clock, const study::Check& check);
  /// Black until then, with the time left and the words when there are any.
  void wait(const PauseWords& words, std::int64_t until_ns, const study::Clock& clock,
            const study::Check& check);
  /// The words on black, without a time, until `over` is true.
  void show_words(const PauseWords& words, const std::function<bool()>& over, const study::Clock& clock,
                  const study::Check& check);
  /// From now on the session is over, or another one begins: over, Esc means nothing, and who closes the
  /// window just leaves (study::Stopped).
  void set_over(bool over);
  /// Black, handed over now.
  void show_black();
  /// From now on the experimenter sees the participant's view too. base::Error as MirrorWindow.
  void open_mirror();
  /// For the mirror, where one is open: the picture of a stimulus in this framebuffer object, which was just
  /// handed over.
  void mirror(unsigned framebuffer);

  /// Takes in what happened to the window, waiting up to wait_s for it. base::Error when it was closed or the
  /// display is gone.
  void poll(double wait_s);
  /// To be asked by the session: what `others` wish, else the end of the session if the participant said so.
  /// Esc during a stimulus asks here; the trial is then over or shown again. It is shown again too when the
  /// window was minimised during a stimulus, once it is back.
  study::Wish wish(const std::function<study::Wish()>& others);

  GlfwWindow& window() { return window_; }
  const DeskWords& words() const { return words_; }
  /// Size at the start, px; it is not to change.
  GlfwWindow::Size size() const { return size_; }
  /// Where the mouse is, px from the lower left corner; none outside.
  std::optional<std::pair<double, double>> mouse() const;

 private:
  bool handle_keys(PageState& state, PageView& view, std::int64_t now_ns);
  void draw(PageView& view, PageState& state, std::int64_t now_ns);
  /// True when the participant wishes to stop.
  bool ask_to_stop(const study::Clock& clock, const study::Check& check);
  /// One of two on a page above others; none: Esc was pressed.
  std::optional<bool> ask_first(const DeskChoice& choice, const char* layer, const study::Clock& clock,
                                const study::Check& check);
  /// Waits a moment; true when Esc was pressed, and answered with the wish to stop or not.
  bool look_up(double wait_s, const study::Clock& clock, const study::Check& check);
  std::string corner() const { return over_ ? std::string() : words_.corner; }
  /// Hands over what was drawn.
  void swap();
  void show_cursor(bool shown);
  void forget_input();
  /// Until the window is back, or others wish the end.
  study::Wish wait_while_minimised(const std::function<study::Wish()>& others);

  GlfwWindow window_;
  GlfwWindow::Size size_;
  Gui gui_;
  const DeskWords& words_;
  Gamepad gamepad_;
  bool in_page_ = false;  ///< Esc is answered there
  bool stop_wished_ = false;
  bool over_ = false;  ///< see set_over()
  bool away_ = false;  ///< the last wish was NotShown: the window may still be minimised
  std::unique_ptr<MirrorWindow> mirror_;
};

}  // namespace apps
