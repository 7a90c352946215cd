#include "libstudy/pages/gui/pages.hpp"

#include <algorithm>
#include <cmath>

namespace study {

namespace {

// Longest wait for input, s. After each wait on a page, the session's callback `check` may end the page.
constexpr double poll_s = 0.03;
// Longest wait on the page of a Reaction, which measures the time to a press, s: short, because a gamepad is
// read only once in each wait.
constexpr double reaction_poll_s = 0.002;

/// Exception that closes the stop dialog when the session ends for another reason.
struct Overruled {
  Request request;
};

/// Sets a flag during its lifetime.
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

bool leaves_field(const PageEvent& event) {
  return event.key == PageKey::Next || event.key == PageKey::Previous;
}

// Time before the end of a black pause at which before_stimulus_ is called, ns. In a window on a 50 Hz
// screen, the function needs 200 ms: it finds the screen's beat (the instant of a refresh) with 10 swaps.
constexpr std::int64_t before_stimulus_ns = 250'000'000;

}  // namespace

Pages::Pages(PageSurface& surface, const std::string& language, const Clock& clock)
    : surface_(surface), words_(desk_words(language)), clock_(clock) {}

std::string Pages::corner() const {
  if (over_) return {};
  return surface_.gui().by_hand() ? words_.corner_by_hand : words_.corner;
}

void Pages::draw(PageView& view, PageState& state) {
  surface_.begin(colour::background);
  view.draw(state, now_ns());
  surface_.end();
}

/// Applies the surface's events to the page. Returns true if one of them is a request to stop.
bool Pages::handle_events(PageState& state, PageView& view) {
  const std::int64_t now_ns = this->now_ns();
  bool stop = false;
  for (const PageEvent& event : surface_.take_events()) {
    const bool by_keyboard = event.input == AnswerInput::Keyboard;
    state.use(event.input);
    stop = stop || event.stop;
    if (by_keyboard && view.typing(state) && !leaves_field(event)) continue;
    if (event.pressed) state.react(now_ns);
    const bool moves_mark = event.key && state.on_line();
    if (state.size() == 0 || (!event.text_only && !moves_mark)) view.scroll(event.lines);
    if (!event.letters.empty() && view.fills_words(state)) {
      state.type(event.letters, now_ns);
      continue;
    }
    if (event.digit >= 0) state.digit(event.digit, now_ns);
    if (event.minus) state.minus(now_ns);
    state.letter(event.letters, now_ns);
    if (event.key && by_keyboard) state.press(*event.key, now_ns);
    if (event.key && !by_keyboard) view.press(state, *event.key, now_ns);
  }
  state.use(surface_.pointer());  // for clicks, which the page handles while it is drawn
  return stop;
}

std::vector<TimedAnswer> Pages::run_page(PageText text, std::span<const Question> questions, double least_s,
                                         const Check& check, const std::function<void()>& shown) {
  const While here(in_page_);
  surface_.show_cursor(true);
  text.corner = corner();
  PageView view(surface_.gui(), words_, std::move(text));
  // Draws the page twice before showing it, because the first drawing measures sizes.
  PageState unseen(questions, least_s, now_ns());
  for (int i = 0; i < 2; ++i) draw(view, unseen);
  surface_.show();
  if (shown) shown();
  surface_.forget_input();
  PageState state(questions, least_s, now_ns());
  while (!state.confirmed()) {
    surface_.poll(state.timed() ? reaction_poll_s : poll_s);
    check();
    if (const auto away = surface_.take_away()) state.leave_out(away->first, away->second);
    const std::int64_t begun_ns = now_ns();
    if (handle_events(state, view) && !over_) {
      stop_requested_ = ask_to_stop(check);
      check();
      draw(view, state);
      surface_.show();
      state.leave_out(begun_ns, now_ns());
      surface_.take_away();
      continue;
    }
    if (state.timed() && surface_.unseen()) state.leave_out(now_ns(), now_ns());
    state.tick(now_ns());
    // Drawing would wait for the screen's refresh, and the page of a Reaction does not change.
    if (state.timed() && !surface_.gui().by_hand()) continue;
    draw(view, state);
    surface_.show();
  }
  surface_.show_black();
  surface_.take_unseen();  // discards the cause: a page that was not seen cuts no trial
  return state.answers();
}

std::optional<bool> Pages::ask_first(const DeskChoice& choice, const char* layer, const Check& check) {
  Question question;
  question.id = "choice";
  question.kind = AnswerKind::Choice;
  question.text = choice.question;
  question.anchors = {{1, choice.first}, {2, choice.second}};
  const While here(in_page_);
  surface_.show_cursor(true);
  PageView view(surface_.gui(), words_, {choice.title, choice.text}, layer);
  PageState state({&question, 1}, 0, now_ns());
  while (!state.confirmed()) {
    surface_.poll(poll_s);
    check();
    if (const auto away = surface_.take_away()) state.leave_out(away->first, away->second);
    if (handle_events(state, view) && !state.guarded(now_ns())) return {};
    draw(view, state);
    surface_.show();
  }
  return state.answers()[0].answer.score == 1;
}

bool Pages::ask_to_stop(const Check& check) { return !ask_first(words_.stop, "stop", check).value_or(true); }

bool Pages::choose_first(const DeskChoice& choice, const Check& check) {
  std::optional<bool> first;
  while (!first) first = ask_first(choice, "choice", check);
  surface_.show_black();
  return *first;
}

bool Pages::look_up(double wait_s, const Check& check) {
  PageState none({}, 0, now_ns());
  PageView nothing(surface_.gui(), words_, {});
  surface_.poll(wait_s);
  check();
  if (!handle_events(none, nothing) || over_) return false;
  stop_requested_ = ask_to_stop(check);
  check();
  surface_.show_black();
  return true;
}

void Pages::wait(const PauseWords& words, std::int64_t until_ns, const Check& check) {
  const While here(in_page_);
  surface_.show_black();
  int drawn_s = -1;
  for (std::int64_t now_ns = this->now_ns(); now_ns < until_ns; now_ns = this->now_ns()) {
    const double left_s = 1e-9 * static_cast<double>(until_ns - now_ns);
    if (look_up(std::min(poll_s, left_s), check)) drawn_s = -1;
    const int whole_s = static_cast<int>(std::ceil(left_s));
    if (words.none() || (whole_s == drawn_s && !surface_.gui().by_hand())) continue;
    drawn_s = whole_s;
    surface_.begin(colour::black);
    draw_countdown(surface_.gui(), words, whole_s, corner());
    surface_.end();
    surface_.show();
  }
  surface_.forget_input();
  if (drawn_s >= 0) surface_.show_black();
}

void Pages::show_words(const PauseWords& words, const std::function<bool()>& over, const Check& check) {
  const While here(in_page_);
  surface_.show_cursor(false);
  for (bool drawn = false; !over();) {
    if (!drawn || surface_.gui().by_hand()) {
      surface_.begin(colour::black);
      draw_words(surface_.gui(), words, corner());
      surface_.end();
      surface_.show();
    }
    drawn = !look_up(poll_s, check);
  }
  surface_.forget_input();
  surface_.show_black();
}

void Pages::set_over(bool over) {
  over_ = over;
  stop_requested_ = false;
  surface_.set_over(over);
}

Request Pages::wait_while_unseen(const std::function<Request()>& others) {
  do {  // runs at least once: the surface may report late that it cannot be seen
    surface_.poll(poll_s);
    const Request other = others ? others() : Request::GoOn;
    if (other == Request::Stop || other == Request::EndSession) return other;
  } while (surface_.unseen());
  away_ = false;
  surface_.forget_input();
  surface_.show_black();
  return Request::GoOn;
}

Request Pages::request(const std::function<Request()>& others) {
  const Request request = others ? others() : Request::GoOn;
  if (stop_requested_ && request != Request::Stop) return Request::EndSession;
  if (in_page_ || request != Request::GoOn) return request;
  if (away_) return wait_while_unseen(others);
  const auto unseen = surface_.take_unseen();
  away_ = unseen.has_value();
  if (unseen) return *unseen;  // the session stores the cut; the next call waits
  const auto events = surface_.take_events();
  if (std::none_of(events.begin(), events.end(), [](const PageEvent& event) { return event.stop; }))
    return request;
  const auto check = [&others] {
    const Request other = others ? others() : Request::GoOn;
    if (other == Request::Stop || other == Request::EndSession) throw Overruled{other};
  };
  try {
    stop_requested_ = ask_to_stop(check);
  } catch (const Overruled& overruled) {
    return overruled.request;
  }
  surface_.show_black();
  if (stop_requested_) return Request::EndSession;
  return CutCause::Participant;
}

PageText PageParticipant::page_of(const Block& block) {
  PageText page{block.title, block.text};
  if (!begun_) page.text += (page.text.empty() ? "" : "\n\n") + pages_->beginning();
  begun_ = true;
  if (block.id == last_block_) page.button = pages_->words().finish;
  return page;
}

void PageParticipant::read(const Block& block, double least_s, Clock&, const Check& check) {
  pages_->run_page(page_of(block), {}, least_s, check);
  if (block.id == last_block_) begun_ = false;
}

std::vector<TimedAnswer> PageParticipant::ask(const Block& block, std::span<const Question> questions,
                                              const Occasion&, Clock&, const Check& check) {
  auto answers = pages_->run_page(page_of(block), questions, 0, check, [this] { page_is_shown(); });
  if (block.id == last_block_) begun_ = false;
  return answers;
}

void PageParticipant::pause(const Pause& pause, Clock&, const Check& check) {
  const DeskWords& words = pages_->words();
  const std::int64_t until_ns = pages_->now_ns() + std::llround(1e9 * pause.seconds);
  const auto said = [&pause](const std::string& usual) {
    return PauseWords{pause.title.empty() && pause.text.empty() ? usual : pause.title, pause.text};
  };
  switch (pause.kind) {
    case PauseKind::Black:
      pages_->wait({}, until_ns - before_stimulus_ns, check);
      before_stimulus_();
      return pages_->wait({}, until_ns, check);
    case PauseKind::Rest:
      return pages_->wait(said(words.rest), until_ns, check);
    case PauseKind::Break:
      pages_->wait(said(words.pause), until_ns, check);
      pages_->run_page({words.ready, ""}, {}, 0, check);
      return;
    case PauseKind::First:
    case PauseKind::Second: {
      const bool first = pause.kind == PauseKind::First;
      const auto over = [&] { return pages_->now_ns() >= until_ns; };
      return pages_->show_words({first ? words.first : words.second, ""}, over, check);
    }
    case PauseKind::Held:
      return pages_->show_words({words.held_title, words.held}, pause.over, check);
    case PauseKind::Trouble:
      if (pause.over) return pages_->show_words({words.trouble_title, words.trouble}, pause.over, check);
      pages_->run_page({words.trouble_title, words.trouble}, {}, 0, check);
      return;
  }
}

void PageParticipant::tell(Notice notice, double least_s, Clock&, const Check& check) {
  const DeskPage& page = pages_->words().page(notice);
  pages_->set_over(true);
  pages_->run_page({page.title, page.text, page.button}, {}, least_s, check);
  if (notice == Notice::Over) return;
  // A session of another person may follow.
  pages_->set_over(false);
  begun_ = false;
}

bool PageParticipant::offer(Offer offer, Clock&, const Check& check) {
  const bool first = pages_->choose_first(pages_->words().choice(offer), check);
  return offer == Offer::StayOut ? !first : first;
}

}  // namespace study
