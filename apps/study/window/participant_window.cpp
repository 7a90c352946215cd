#include "apps/study/window/participant_window.hpp"

// epoxy first: GLFW then leaves GL's headers alone.
#include <epoxy/gl.h>

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/study/window/page_keys.hpp"
#include "libsim/render/gl_context.hpp"
#include "stats/base/error.hpp"

namespace apps {

namespace {

// The session's check is due every 50 ms.
constexpr double poll_s = 0.03;
constexpr unsigned black = IM_COL32(0, 0, 0, 255);

WindowChoice as_window(const ParticipantWindowOptions& options) {
  return {"vip-study", options.width_px, options.height_px, options.monitor,
          "use --display headless or none on a machine without a screen"};
}

/// Thrown out of the question whether to stop when the session ends for another reason.
struct Overruled {
  study::Wish wish;
};

/// A flag that is true while it lives.
class While {
 public:
  explicit While(bool& flag) : flag_(flag), before_(flag) { flag_ = true; }
  ~While() { flag_ = before_; }
  While(const While&) = delete;
  While& operator=(const While&) = delete;

 private:
  bool& flag_;
  bool before_;
};

}  // namespace

ParticipantWindow::ParticipantWindow(const ParticipantWindowOptions& options)
    : window_(as_window(options)),
      size_(window_.size()),
      gui_(window_.get(), size_.height),
      words_(desk_words(options.language)) {
  sim::require_gl45();
  show_black();
}

void ParticipantWindow::poll(double wait_s) {
  if (wait_s > 0)
    glfwWaitEventsTimeout(wait_s);
  else
    glfwPollEvents();
  if (GlfwWindow::display_is_gone()) {
    throw base::Error("the participant's window", "the display is gone; all answers given are kept",
                      "bring it back and continue with vip-study resume");
  }
  if (window_.asked_to_close()) {
    if (over_) throw study::Stopped();
    throw base::Error("the participant's window", "was closed; all answers given are kept",
                      "continue with vip-study resume");
  }
}

void ParticipantWindow::show_cursor(bool shown) {
  glfwSetInputMode(window_.get(), GLFW_CURSOR, shown ? GLFW_CURSOR_NORMAL : GLFW_CURSOR_HIDDEN);
}

void ParticipantWindow::forget_input() {
  glfwPollEvents();
  window_.take_keys();
  window_.take_minimised();
  gamepad_.forget();
}

void ParticipantWindow::show_black() {
  show_cursor(false);
  gui_.begin(black);
  gui_.end();
  glfwSwapBuffers(window_.get());
  if (mirror_) mirror_->take_black();
}

void ParticipantWindow::swap() {
  if (mirror_) mirror_->take(0);
  glfwSwapBuffers(window_.get());
}

void ParticipantWindow::open_mirror() { mirror_ = std::make_unique<MirrorWindow>(window_); }

void ParticipantWindow::mirror(unsigned framebuffer) {
  if (mirror_) mirror_->take_some(framebuffer);
}

void ParticipantWindow::draw(PageView& view, PageState& state, std::int64_t now_ns) {
  gui_.begin(colour::background);
  view.draw(state, now_ns);
  gui_.end();
}

/// Returns whether Esc was among them.
bool ParticipantWindow::handle_keys(PageState& state, PageView& view, std::int64_t now_ns) {
  bool escape = false;
  state.use(study::AnswerInput::Keyboard);
  const bool shift = glfwGetKey(window_.get(), GLFW_KEY_LEFT_SHIFT) == GLFW_PRESS ||
                     glfwGetKey(window_.get(), GLFW_KEY_RIGHT_SHIFT) == GLFW_PRESS;
  for (const int key : window_.take_keys()) {
    if (key == GLFW_KEY_ESCAPE) escape = true;
    if (view.typing(state) && key != GLFW_KEY_TAB) continue;
    if (state.size() == 0 || key == GLFW_KEY_PAGE_DOWN || key == GLFW_KEY_PAGE_UP) view.scroll(lines_of(key));
    if (digit_of(key) >= 0) state.digit(digit_of(key), now_ns);
    if (key == GLFW_KEY_MINUS || key == GLFW_KEY_KP_SUBTRACT) state.minus(now_ns);
    if (const auto meant = page_key(key, shift)) state.press(*meant, now_ns);
  }
  state.use(study::AnswerInput::Gamepad);
  for (const PageKey key : gamepad_.take()) state.press(key, now_ns);
  state.use(study::AnswerInput::Mouse);  // clicks come while the page is drawn
  return escape;
}

std::vector<study::TimedAnswer> ParticipantWindow::run_page(PageText text,
                                                            std::span<const study::Question> questions,
                                                            double least_s, const study::Clock& clock,
                                                            const study::Check& check) {
  const While here(in_page_);
  show_cursor(true);
  text.corner = corner();
  PageView view(gui_, words_, std::move(text));
  // Drawn twice before it is shown: the first time measures.
  PageState unseen(questions, least_s, clock.now_ns());
  for (int i = 0; i < 2; ++i) draw(view, unseen, clock.now_ns());
  swap();
  forget_input();
  PageState state(questions, least_s, clock.now_ns());
  while (!state.confirmed()) {
    poll(poll_s);
    check();
    const std::int64_t now_ns = clock.now_ns();
    if (handle_keys(state, view, now_ns) && !over_) {
      stop_wished_ = ask_to_stop(clock, check);
      check();
      state.leave_out(now_ns, clock.now_ns());
      continue;
    }
    draw(view, state, now_ns);
    swap();
  }
  show_black();
  window_.take_minimised();  // that the page was away for a while does no harm
  return state.answers();
}

std::optional<bool> ParticipantWindow::ask_first(const DeskChoice& choice, const char* layer,
                                                 const study::Clock& clock, const study::Check& check) {
  study::Question question;
  question.id = "choice";
  question.kind = study::AnswerKind::Choice;
  question.text = choice.question;
  question.anchors = {{1, choice.first}, {2, choice.second}};
  const While here(in_page_);
  show_cursor(true);
  PageView view(gui_, words_, {choice.title, choice.text}, layer);
  PageState state({&question, 1}, 0, clock.now_ns());
  while (!state.confirmed()) {
    poll(poll_s);
    check();
    if (handle_keys(state, view, clock.now_ns()) && !state.guarded(clock.now_ns())) return {};
    draw(view, state, clock.now_ns());
    swap();
  }
  return state.answers()[0].answer.score == 1;
}

bool ParticipantWindow::ask_to_stop(const study::Clock& clock, const study::Check& check) {
  return !ask_first(words_.stop, "stop", clock, check).value_or(true);
}

bool ParticipantWindow::choose_first(const DeskChoice& choice, const study::Clock& clock,
                                     const study::Check& check) {
  std::optional<bool> first;
  while (!first) first = ask_first(choice, "choice", clock, check);
  show_black();
  return *first;
}

bool ParticipantWindow::look_up(double wait_s, const study::Clock& clock, const study::Check& check) {
  PageState none({}, 0, clock.now_ns());
  PageView nothing(gui_, words_, {});
  poll(wait_s);
  check();
  if (!handle_keys(none, nothing, clock.now_ns()) || over_) return false;
  stop_wished_ = ask_to_stop(clock, check);
  check();
  show_black();
  return true;
}

void ParticipantWindow::wait(const PauseWords& words, std::int64_t until_ns, const study::Clock& clock,
                             const study::Check& check) {
  const While here(in_page_);
  show_black();
  int drawn_s = -1;
  for (std::int64_t now_ns = clock.now_ns(); now_ns < until_ns; now_ns = clock.now_ns()) {
    const double left_s = 1e-9 * static_cast<double>(until_ns - now_ns);
    if (look_up(std::min(poll_s, left_s), clock, check)) drawn_s = -1;
    const int whole_s = static_cast<int>(std::ceil(left_s));
    if (words.none() || whole_s == drawn_s) continue;
    drawn_s = whole_s;
    gui_.begin(black);
    draw_countdown(gui_, words, whole_s, corner());
    gui_.end();
    swap();
  }
  forget_input();
  if (drawn_s >= 0) show_black();
}

void ParticipantWindow::show_words(const PauseWords& words, const std::function<bool()>& over,
                                   const study::Clock& clock, const study::Check& check) {
  const While here(in_page_);
  show_cursor(false);
  for (bool drawn = false; !over();) {
    if (!drawn) {
      gui_.begin(black);
      draw_words(gui_, words, corner());
      gui_.end();
      swap();
    }
    drawn = !look_up(poll_s, clock, check);
  }
  forget_input();
  show_black();
}

void ParticipantWindow::set_over(bool over) {
  over_ = over;
  stop_wished_ = false;
}

study::Wish ParticipantWindow::wait_while_minimised(const std::function<study::Wish()>& others) {
  while (window_.minimised()) {
    poll(poll_s);
    const study::Wish other = others ? others() : study::Wish::GoOn;
    if (other == study::Wish::Stop || other == study::Wish::EndSession) return other;
  }
  away_ = false;
  forget_input();
  show_black();
  return study::Wish::GoOn;
}

study::Wish ParticipantWindow::wish(const std::function<study::Wish()>& others) {
  const study::Wish wish = others ? others() : study::Wish::GoOn;
  if (stop_wished_ && wish != study::Wish::Stop) return study::Wish::EndSession;
  if (in_page_ || wish != study::Wish::GoOn) return wish;
  if (away_) return wait_while_minimised(others);
  away_ = window_.take_minimised();
  if (away_) return study::Wish::NotShown;  // the cut is kept first, then the window is waited for
  const auto keys = window_.take_keys();
  if (std::find(keys.begin(), keys.end(), GLFW_KEY_ESCAPE) == keys.end()) return wish;
  const auto check = [&others] {
    const study::Wish other = others ? others() : study::Wish::GoOn;
    if (other == study::Wish::Stop || other == study::Wish::EndSession) throw Overruled{other};
  };
  try {
    stop_wished_ = ask_to_stop(study::RealClock(), check);
  } catch (const Overruled& overruled) {
    return overruled.wish;
  }
  show_black();
  return stop_wished_ ? study::Wish::EndSession : study::Wish::RepeatTrial;
}

std::optional<std::pair<double, double>> ParticipantWindow::mouse() const {
  double x = 0, y = 0;
  if (!window_.mouse(x, y)) return {};
  return std::pair{x, y};
}

}  // namespace apps
